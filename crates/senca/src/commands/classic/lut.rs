//! `senca classic lut`: the look-up table editor of 1991.

use std::io::BufRead;
use std::path::PathBuf;

use clap::{Args, ValueHint};
use senca::classic::thesis::{LutEditor, LutWindow, paint};
use senca::io::classic::IndexBitmap;
use serde_json::json;

use super::colors::{ColorArguments, DiskFiles, Palette, read_bitmap, write_picture};
use super::dialogue::read_line;
use crate::cli::interactive::{self, InteractiveArguments};
use crate::cli::output::{check_writable, print};
use crate::cli::{Failure, Interrupt};

/// Which picture, and how it is coloured.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// Bitmap of colour indices, as the renderer writes it. With -o it is written in its colours;
    /// with --window or --script it is edited in a window; otherwise on the terminal
    #[arg(value_name = "BITMAP", value_hint = ValueHint::FilePath)]
    bitmap: Option<PathBuf>,

    #[command(flatten)]
    colors: ColorArguments,

    /// Computes the table as the printed listing does, and takes what it takes
    #[arg(long)]
    as_printed: bool,

    /// Prints the table as JSON
    #[arg(long)]
    json: bool,

    #[command(flatten)]
    interactive: InteractiveArguments,
}

/// Colours the picture, or lets the user do it.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let bitmap = arguments.bitmap.as_deref().map(read_bitmap).transpose()?;
    let colors = ColorArguments {
        colors: Some(arguments.colors.colors.unwrap_or_else(|| colors_of(bitmap.as_ref()))),
        ..arguments.colors.clone()
    };
    let mut files = DiskFiles { interrupt: Interrupt::listen() };
    let interrupt = files.interrupt.clone();
    let mut editor = LutEditor::new(colors.count());
    if arguments.as_printed {
        editor = editor.as_printed();
    }
    if let Some(bitmap) = bitmap {
        editor = editor.with_bitmap(bitmap);
    }
    let how = &arguments.interactive;
    if colors.profile.len() > 1
        && let Some(path) = how.output.as_ref().filter(|_| !how.window && how.script.is_none())
    {
        check_writable(path)?;
        let lut = colors.lut(colors.profile.len() as u32)?;
        return write_picture(path, &paint(editor.bitmap(), &lut), &interrupt);
    }
    match colors.profile()? {
        Some(profile) => editor = editor.with_profile(profile),
        // The editor begins with greys; another palette is one of its commands.
        None if colors.palette == Some(Palette::Ega) => {
            colors.lut(1)?;
            editor.line("E", &mut files);
        }
        None => {}
    }
    if how.window || how.script.is_some() {
        let mut window = LutWindow::new(editor, Box::new(files));
        interactive::run(&mut window, "lut", how, &interrupt)?;
        return if arguments.json { print(&table(window.editor())) } else { Ok(()) };
    }
    if how.size.is_some() {
        return Err(Failure::usage("--size is the window's; a bitmap has its own"));
    }
    if let Some(path) = &how.output {
        check_writable(path)?;
        write_picture(path, &paint(editor.bitmap(), editor.lut()), &interrupt)?;
    } else if !arguments.json {
        return terminal(&mut editor, &mut files, &mut std::io::stdin().lock());
    }
    if arguments.json { print(&table(&editor)) } else { Ok(()) }
}

/// As many colours as hold the bitmap's indices: 16, 256 or 65536.
fn colors_of(bitmap: Option<&IndexBitmap>) -> u32 {
    match bitmap.and_then(|bitmap| bitmap.indices.iter().max()) {
        Some(16..=255) => 256,
        Some(256..) => 65_536,
        _ => 16,
    }
}

/// The editor's dialogue, until X or the end of the input.
fn terminal(editor: &mut LutEditor, files: &mut DiskFiles, input: &mut dyn BufRead) -> Result<(), Failure> {
    print(&editor.greeting())?;
    loop {
        print(&editor.prompt())?;
        let Some(line) = read_line(input)? else { return print("\n") };
        let reply = editor.line(&line, files);
        print(&reply.text)?;
        if reply.exit {
            return Ok(());
        }
    }
}

fn table(editor: &LutEditor) -> String {
    let nodes: Vec<_> =
        editor.profile().nodes.iter().map(|node| json!({ "rgb": node.rgb, "x": node.x })).collect();
    let object =
        json!({ "nodes": nodes, "background": editor.profile().background, "lut": editor.lut().colors });
    format!("{object:#}\n")
}
