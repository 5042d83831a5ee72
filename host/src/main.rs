//! The `etendue` program.

use clap::Parser;
use etendue_host::command::{Command, Failure};
use std::process::ExitCode;

/// Light transport: renders scenes, compiles them to blobs, compares images.
#[derive(Parser)]
#[command(name = "etendue", version, about, max_term_width = 100)]
struct Program {
    #[command(subcommand)]
    command: Command,
}

fn main() -> ExitCode {
    match Program::parse().command.run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(Failure::Interrupted) => ExitCode::from(130),
        Err(Failure::Error(message)) => {
            eprintln!("error: {message}");
            ExitCode::FAILURE
        }
    }
}
