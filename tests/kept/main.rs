//! Nothing is lost: runs that are killed, or whose files can't be written, end where they would have ended; runs are never mixed.
//!
//! `NERF_ORACLE_KILLS=20` kills each kind of run 20 times instead of once, and tries every fault.

mod faults;
mod kills;
mod program;
mod refused;
