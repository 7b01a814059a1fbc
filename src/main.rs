//! The program: parse, run, exit code.

use std::process::ExitCode;

fn main() -> ExitCode {
    nerf_oracle::cli::main(std::env::args_os())
}
