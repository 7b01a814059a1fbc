//! Nothing is lost: runs that are killed, or whose files can't be written, end where they would have ended; runs are never mixed.
//!
//! `NERF_ORACLE_KILLS=20` kills each kind of run 20 times instead of once, and tries every fault; one in twelve is tried by default, one
//! in four with `NERF_ORACLE_TYPES=all`.

mod faults;
mod kills;
mod program;
mod refused;
#[path = "../types/mod.rs"]
mod types;
