//! The `etendue` program.

use clap::Parser;
use etendue_host::command::{Command, Failure};
use etendue_host::memory::Allocator;
use std::process::ExitCode;

#[global_allocator]
static MEMORY: Allocator = Allocator;

/// Light transport: renders scenes, compiles them to blobs, compares images.
///
/// Exit codes: 0 done, 1 refused or failed (one line on standard error says why, and nothing is written),
/// 2 wrong usage, 130 ended by Ctrl-C.
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
            // One line, whatever a library's message has in it.
            let line: Vec<&str> = message.split_whitespace().collect();
            eprintln!("error: {}", line.join(" "));
            ExitCode::FAILURE
        }
    }
}
