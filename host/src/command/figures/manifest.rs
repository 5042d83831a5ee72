//! What a contact sheet shows, as data. A line of the manifest is a panel: a scene and flags as `etendue render` takes them,
//! then ` | ` and a caption. An empty line begins a new row, `#` a comment.

use super::super::how::How;
use super::super::reading::Reading;
use super::super::screen::Screen;
use crate::develop::can_write;
use clap::Parser;
use std::path::{Path, PathBuf};

/// A line of the manifest, without its caption.
#[derive(Parser, Debug)]
#[command(no_binary_name = true, disable_help_flag = true)]
pub struct Panel {
    /// The scene, from the manifest's folder
    pub scene: PathBuf,
    #[command(flatten)]
    pub how: How,
    /// Samples per pixel
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..=1 << 40))]
    pub spp: Option<u64>,
    #[command(flatten)]
    pub reading: Reading,
    #[command(flatten)]
    pub screen: Screen,
}

/// A panel, and where and what it is said to be.
#[derive(Debug)]
pub struct Entry {
    /// Line of the manifest, from 1.
    pub line: usize,
    /// Scene and flags.
    pub panel: Panel,
    /// Caption.
    pub caption: String,
}

/// Reads the manifest `file` into rows of panels.
///
/// # Errors
/// One line: the file, the line in it, what is wrong.
pub fn read(file: &Path) -> Result<Vec<Vec<Entry>>, String> {
    let text = std::fs::read_to_string(file)
        .map_err(|e| format!("{}: can't be read: {e}", file.display()))?;
    let mut rows = vec![Vec::new()];
    for (line, text) in (1..).zip(text.lines()) {
        let text = text.trim();
        if text.is_empty() {
            rows.push(Vec::new());
        } else if !text.starts_with('#') {
            let entry = entry(line, text).map_err(|e| format!("{}:{line}: {e}", file.display()))?;
            if let Some(row) = rows.last_mut() {
                row.push(entry);
            }
        }
    }
    rows.retain(|row| !row.is_empty());
    if rows.is_empty() {
        let expected = "expected lines like: scene.xml --spp 64 | caption";
        return Err(format!("{}: no panels, {expected}", file.display()));
    }
    Ok(rows)
}

fn entry(line: usize, text: &str) -> Result<Entry, String> {
    let (words, caption) = text
        .split_once(" | ")
        .ok_or("expected a scene, flags, \" | \" and a caption")?;
    if !can_write(caption) {
        return Err(format!(
            "caption: expected printable ASCII, found {caption:?}"
        ));
    }
    let panel = Panel::try_parse_from(words.split_whitespace()).map_err(|e| {
        // Its first paragraph says what is wrong; the rest is about a command line.
        let text = e.to_string();
        let reason = text.split("\n\n").next().unwrap_or_default();
        reason.trim_start_matches("error: ").to_owned()
    })?;
    Ok(Entry {
        line,
        panel,
        caption: caption.trim().to_owned(),
    })
}
