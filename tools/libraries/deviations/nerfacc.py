"""nerfacc."""

from reproduction import deviation


@deviation("nerfacc", "bug", "`_ray_aabb_intersect` calls a box behind `far_plane` a hit")
def box_behind_far():
    """`hits` is taken before t is clamped to [near_plane, far_plane]. Both ends become the far plane: an interval without
    length, reported as a hit. Expected is no hit: the slab [2, 3] has nothing in [0, 1]. The CUDA kernel decides before it
    clamps too (read, not run), and has t_min = 2, t_max = 1 there."""
    import torch
    from nerfacc.grid import _ray_aabb_intersect

    box = torch.tensor([[-1.0, -1.0, 2.0, 1.0, 1.0, 3.0]])
    o, d = torch.zeros(1, 3), torch.tensor([[0.0, 0.0, 1.0]])
    _, _, hits = _ray_aabb_intersect(o, d, box, near_plane=0.0, far_plane=1.0)
    found, expected = [float(hits)], [0.0]
    return found, expected


@deviation("nerfacc", "bug", "`_ray_aabb_intersect` misses a box whose face the ray runs in")
def in_a_face():
    """(low - o) / d is 0 / 0 in that slab, and every comparison with NaN is false. The closed box [0, 1]^3 has the whole of
    this ray's part with 1 <= t <= 2 in it. Kay and Kajiya's slab of d = 0 is all t where low <= o <= high."""
    import torch
    from nerfacc.grid import _ray_aabb_intersect

    box = torch.tensor([[0.0, 0.0, 0.0, 1.0, 1.0, 1.0]])
    o, d = torch.tensor([[-1.0, 0.0, 0.5]]), torch.tensor([[1.0, 0.0, 0.0]])
    _, _, hits = _ray_aabb_intersect(o, d, box)
    found, expected = [float(hits)], [1.0]
    return found, expected


@deviation("nerfacc", "bug", "`OccGridEstimator._update` keeps the last of several samples of a cell, not the largest")
def last_sample_of_a_cell():
    """`occs[cell_ids] = maximum(occs[cell_ids] * ema_decay, occ)` writes a repeated cell once for each sample, and the last write
    stays. After the warm-up cells do repeat: `_sample_uniform_and_occupied_cells` draws with replacement. The comment in the
    source says that a scatter with maximum was meant; torch has it: `occs.scatter_reduce_(0, cell_ids, occ, "amax")`."""
    import torch
    from nerfacc import OccGridEstimator

    grid = OccGridEstimator([0.0, 0.0, 0.0, 1.0, 1.0, 1.0], resolution=2)
    grid._sample_uniform_and_occupied_cells = lambda n: [torch.tensor([3, 3])]
    grid._update(step=256, occ_eval_fn=lambda x: torch.tensor([[5.0], [1.0]]), ema_decay=0.5)
    found, expected = [float(grid.occs[3])], [5.0]
    return found, expected


@deviation("nerfacc", "bug", "`grid._query` takes points on the lower faces of the box for outside")
def query_on_the_lower_face():
    """The level is `frexp(|x - 1/2|)[1] + 1`, and frexp(1/2) has exponent 0: |x - 1/2| = 1/2 counts as the next level, which a
    grid of one level hasn't got. x = 0 belongs to the first cell."""
    import torch
    from nerfacc.grid import _query

    box, occupied = torch.tensor([0.0, 0.0, 0.0, 1.0, 1.0, 1.0]), torch.ones(1, 2, 2, 2, dtype=torch.bool)
    value, _ = _query(torch.tensor([[0.0, 0.3, 0.3]]), occupied, box)
    found, expected = [float(value)], [1.0]
    return found, expected


@deviation("nerfacc", "choice", "`_sample_from_weighted` puts all samples of an empty ray into its last bin")
def samples_of_an_empty_ray():
    """The CDF's last entry is 1 whatever the weights are, so that what isn't absorbed lies in the last bin: meant for a CDF of
    1 - T, not for weights that sum to 0, of which F.normalize makes zeros. 0 / 0 has no right answer; expected here is the
    uniform one."""
    import torch
    from nerfacc.pdf import _sample_from_weighted

    _, centers = _sample_from_weighted(torch.tensor([[0.0, 1.0, 2.0, 3.0]]), torch.zeros(1, 3), 2)
    found, expected = centers[0].tolist(), [0.75, 2.25]
    return found, expected
