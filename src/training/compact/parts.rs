//! What a compact model can do without, so that people see what each part is worth.

/// The parts of a compact model that can be switched off, to see what they are worth (`--without`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Part {
    /// The occupancy grid: every cell counts as occupied.
    Occupancy,
    /// The early stop, and with it the end of rays behind opaque cells: every sample of a ray counts.
    Stop,
    /// Ending rays behind opaque cells, before their samples are evaluated.
    Patience,
    /// Coarse steps along the rays at first.
    CoarseSteps,
    /// Coarse levels of the hash grid first.
    CoarseLevels,
    /// Batches that grow with the step.
    Growth,
    /// Learning rates that fall.
    Decay,
    /// Colors that depend on the direction.
    ViewDependence,
    /// All colors behind pictures that have opacity: the scene's background instead.
    RandomBackgrounds,
    /// The distortion loss against floaters.
    Distortion,
    /// Pictures of the parameters' running mean.
    Averaging,
}

impl Part {
    /// All of them.
    pub const ALL: [Part; 11] = [
        Part::Occupancy,
        Part::Stop,
        Part::Patience,
        Part::CoarseSteps,
        Part::CoarseLevels,
        Part::Growth,
        Part::Decay,
        Part::ViewDependence,
        Part::RandomBackgrounds,
        Part::Distortion,
        Part::Averaging,
    ];
}
