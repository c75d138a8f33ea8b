//! `senca lab 8`: Mandelbrot and Julia sets, to any depth.

use std::path::{Path, PathBuf};

use clap::Args;
use senca::math::Control;
use senca_classic::lab::LabError;
use senca_classic::lab::fractal::{
    Coloring, Counts, Family, Fixed, Level, MAX_BOUND, MAX_ITERATIONS, Parameters, Picture, View, Wide,
    brute_counts, colored, counts, deep_counts, leave, literal_counts, trace, zoom_widths,
};
use senca_classic::lab::programs::FractalProgram;
use senca_window::{Canvas, Event, Flow, Program};
use serde_json::{Value, json};

use super::{Failure, Shown, Source};
use crate::cli::values::{Pixel, positive};
use crate::cli::{Interrupt, Progress, interactive, use_threads};

/// Names of the loops.
const LOOP_NAMES: [&str; 4] = ["auto", "literal", "perturbation", "digits"];

/// Which set, where, and how.
#[derive(Args, Debug)]
pub(super) struct Arguments {
    #[command(flatten)]
    source: Source,

    /// The manual's example that is begun with
    #[arg(long, value_name = "NAME", value_parser = ["mandelbrot", "julia"], default_value = "mandelbrot")]
    set: String,

    /// eps: a point has left when |z| reaches it
    #[arg(long, value_name = "N", value_parser = positive)]
    eps: Option<f64>,

    /// m: how often z is squared after the first time
    #[arg(short = 'm', long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=MAX_ITERATIONS))]
    iterations: Option<u32>,

    /// The constant of a Julia set, with as many digits as it takes
    #[arg(long, value_name = "RE,IM", allow_hyphen_values = true)]
    c: Option<String>,

    /// The point in the middle of the picture, with as many digits as it takes
    #[arg(long, value_name = "RE,IM", allow_hyphen_values = true)]
    center: Option<String>,

    /// Width of the picture, such as 3 or 2e-50; pixels are square
    #[arg(long, value_name = "W")]
    width: Option<String>,

    /// How it is computed: by the manual's loop, by perturbation, or with all digits for every pixel;
    /// auto takes a quick loop where the processor's numbers are enough, and perturbation where not
    #[arg(long = "loop", value_name = "NAME", value_parser = LOOP_NAMES, default_value = "auto")]
    method: String,

    /// Lets the last column and row lie at umax and vmax
    #[arg(long)]
    reach_ends: bool,

    /// Colours without steps
    #[arg(long)]
    smooth: bool,

    /// Counts from a colour to its return
    #[arg(long, value_name = "N", default_value = "24", value_parser = positive)]
    period: f64,

    /// Tells k of one pixel and |z| after each of its iterations
    #[arg(long, value_name = "X,Y")]
    pixel: Option<Pixel>,

    /// Writes so many pictures of a zoom to --width: OUT-000.png and so on for -o OUT.png
    #[arg(long, value_name = "N", requires = "output", value_parser = clap::value_parser!(u32).range(2..=100_000))]
    frames: Option<u32>,

    /// Width that the zoom begins with
    #[arg(long, value_name = "W", default_value = "4", requires = "frames")]
    from_width: String,

    /// Threads; all cores when left out
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,

    /// No progress bar
    #[arg(long)]
    quiet: bool,

    #[command(flatten)]
    shown: Shown,
}

/// What is computed: an area as the manual gives it, or a view of any depth.
enum Job {
    Area(Parameters),
    View(Picture),
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    use_threads(arguments.threads)?;
    let job = job(arguments)?;
    if arguments.shown.is_driven() {
        let mut program = FractalProgram::new(picture_of(&job), coloring(arguments));
        return arguments.shown.present(&mut program, "lab-8");
    }
    if let Some(frames) = arguments.frames {
        return write_zoom(arguments, &picture_of(&job), frames as usize);
    }
    let interrupt = Interrupt::listen();
    let counts = computed(arguments, &job, &interrupt)?;
    let (text, json) = report(arguments, &job, &counts)?;
    arguments.shown.print(&text, &json)?;
    if !arguments.shown.is_drawn() {
        return Ok(());
    }
    write_picture(arguments, &counts, arguments.shown.interactive.output.as_deref(), &interrupt)
}

fn coloring(arguments: &Arguments) -> Coloring {
    Coloring { smooth: arguments.smooth, period: arguments.period }
}

fn job(arguments: &Arguments) -> Result<Job, Failure> {
    let julia = arguments.set == "julia";
    let example =
        if julia { "100 16  -1 1  -1.2 1.2  200 200  0.32 0.043" } else { "100 16  -1.5 0.5  -1 1  200 200" };
    let wanted = "eps, m, umin, umax, vmin, vmax, width, height, and for a Julia set both parts of c";
    let mut parameters = arguments.source.read(wanted, example, Parameters::read)?;
    parameters.bound = arguments.eps.unwrap_or(parameters.bound);
    parameters.iterations = arguments.iterations.unwrap_or(parameters.iterations);
    parameters.reach_ends = arguments.reach_ends;
    if let Some(size) = arguments.shown.interactive.size {
        parameters.size = [size.width as usize, size.height as usize];
    }
    let c = arguments.c.as_deref().map(|c| pair(c, "--c")).transpose()?;
    if let Some([re, im]) = c {
        let number = |text: &str| Fixed::parse(text, 4).map(|v| v.to_f64()).map_err(|e| usage("--c", &e));
        parameters.family = Family::Julia { c: [number(re)?, number(im)?] };
    }
    let is_view = arguments.center.is_some() || arguments.width.is_some();
    let by_digits = matches!(arguments.method.as_str(), "perturbation" | "digits");
    if !is_view && !by_digits && arguments.frames.is_none() {
        return Ok(Job::Area(parameters));
    }
    let picture = deep_picture(arguments, &parameters, c)?;
    let needs_digits = by_digits || picture.is_deep();
    if needs_digits && parameters.bound > MAX_BOUND {
        return Err(Failure::usage(format!("with many digits --eps is at most {MAX_BOUND:e}")));
    }
    Ok(Job::View(picture))
}

fn usage(option: &str, error: &dyn std::fmt::Display) -> Failure {
    Failure::usage(format!("{option}: {error}"))
}

fn pair<'a>(text: &'a str, option: &str) -> Result<[&'a str; 2], Failure> {
    let parts = text.split_once(',').map(|(re, im)| [re.trim(), im.trim()]);
    parts.ok_or_else(|| Failure::usage(format!("{option} needs two numbers RE,IM, such as -0.75,0.1")))
}

fn deep_picture(
    arguments: &Arguments,
    parameters: &Parameters,
    c: Option<[&str; 2]>,
) -> Result<Picture, Failure> {
    let area = View::of_area(parameters.u, parameters.v, parameters.size);
    let parsed = |re: &str, im: &str, width: &str| View::parse(re, im, width).map_err(Failure::usage);
    let view = match (&arguments.center, &arguments.width) {
        (Some(center), width) => {
            let [re, im] = pair(center, "--center")?;
            let view = parsed(re, im, width.as_deref().unwrap_or("1"))?;
            if width.is_some() { view } else { View { width: area.width, ..view } }
        }
        (None, Some(width)) => View { width: parsed("0", "0", width)?.width, ..area },
        (None, None) => area,
    };
    let limbs = view.center[0].fraction().max(4);
    let julia = match (c, parameters.family) {
        (Some([re, im]), _) => {
            let part = |text: &str| {
                let limbs = Fixed::limbs_of(text).map_or(limbs, |own| own.max(limbs));
                Fixed::parse(text, limbs).map_err(|e| usage("--c", &e))
            };
            Some([part(re)?, part(im)?])
        }
        (None, Family::Julia { c }) => Some(c.map(|part| Fixed::from_f64(part.clamp(-1e8, 1e8), limbs))),
        (None, Family::Mandelbrot) => None,
    };
    let Parameters { bound, iterations, size, .. } = *parameters;
    Ok(Picture { view, julia, bound, iterations, size })
}

fn picture_of(job: &Job) -> Picture {
    match job {
        Job::View(picture) => picture.clone(),
        Job::Area(p) => Picture {
            view: View::of_area(p.u, p.v, p.size),
            julia: match p.family {
                Family::Mandelbrot => None,
                Family::Julia { c } => Some(c.map(|part| Fixed::from_f64(part.clamp(-1e8, 1e8), 4))),
            },
            bound: p.bound,
            iterations: p.iterations,
            size: p.size,
        },
    }
}

fn computed(arguments: &Arguments, job: &Job, interrupt: &Interrupt) -> Result<Counts, Failure> {
    let progress = Progress::new(arguments.quiet);
    let report = |share: f32| progress.report(share);
    let control = Control { progress: Some(&report), cancel: Some(interrupt.flag()) };
    let counts = match (job, arguments.method.as_str()) {
        (Job::Area(p), "literal") => literal_counts(p, &control),
        (Job::Area(p), _) => counts(p, arguments.smooth, Level::new(), &control),
        (Job::View(p), "literal") => literal_counts(&p.shallow(), &control),
        (Job::View(p), "digits") => brute_counts(&p.deep(), &control),
        (Job::View(p), "perturbation") => deep_counts(&p.deep(), Level::new(), &control),
        (Job::View(p), _) => p.counts(arguments.smooth, &control),
    };
    progress.finish();
    counts.map_err(|_| Failure::Interrupted)
}

fn report(arguments: &Arguments, job: &Job, counts: &Counts) -> Result<(String, Value), Failure> {
    let [width, height] = counts.size;
    let mut text = format!("{width} x {height}, eps = {}, m = {}\n", counts.bound, counts.iterations);
    let histogram = counts.histogram();
    let shown: Vec<_> = histogram.iter().enumerate().filter(|&(_, &n)| n > 0).collect();
    text += "k: pixels\n";
    for (k, n) in shown.iter().take(40) {
        text += &format!("  {k:>6} {n:>10}\n");
    }
    if shown.len() > 40 {
        text += &format!("  and {} more\n", shown.len() - 40);
    }
    text += &format!("sum of k {}, left with the last iteration {}\n", counts.sum(), counts.left_at_last);
    let counted: Vec<_> = shown.iter().map(|&(k, n)| json!([k, n])).collect();
    let mut json = json!({
        "size": counts.size, "eps": counts.bound, "m": counts.iterations, "counts": counted,
        "sum": counts.sum(), "left_at_last": counts.left_at_last,
    });
    if let Job::View(picture) = job {
        let digits = picture.view.digits();
        let center = picture.view.center.each_ref().map(|part| part.to_decimal(digits));
        text += &format!("middle {} {}\n", center[0], center[1]);
        text += &format!("width {}\n", picture.view.width.to_decimal(6));
        json["center"] = json!(center);
        json["width"] = json!(picture.view.width.to_decimal(17));
    }
    if let Some(Pixel { x, y }) = arguments.pixel {
        let (x, y) = (x as usize, y as usize);
        if x >= width || y >= height {
            return Err(Failure::usage(format!("--pixel {x},{y} lies outside of {width}x{height}")));
        }
        let Job::Area(parameters) = job else {
            return Err(Failure::usage("--pixel is for areas, not for --center, --width and many digits"));
        };
        let (z, c) = parameters.start(x, y);
        let moduli = trace(parameters, z, c);
        let moduli_text: Vec<_> = moduli.iter().take(40).map(|r| format!("{r:.6}")).collect();
        let k = leave(parameters, x, y).k;
        text += &format!("pixel {x},{y}: c = {} {}, k = {k}, |z| = {}\n", c[0], c[1], moduli_text.join(" "));
        json["pixel"] = json!({ "x": x, "y": y, "z0": z, "c": c, "k": k, "moduli": moduli });
    }
    Ok((text, json))
}

/// A picture that stays as it is.
struct Still {
    size: [usize; 2],
    pixels: Vec<u32>,
}

impl Program for Still {
    fn title(&self) -> String {
        "Fractal".to_owned()
    }

    fn size(&self) -> (usize, usize) {
        (self.size[0], self.size[1])
    }

    fn event(&mut self, _: Event) -> Flow {
        Flow::Wait
    }

    fn draw(&mut self, canvas: &mut Canvas) {
        for y in 0..self.size[1].min(canvas.height()) {
            let width = self.size[0].min(canvas.width());
            let from = &self.pixels[y * self.size[0]..][..width];
            let at = y * canvas.width();
            canvas.pixels_mut()[at..at + width].copy_from_slice(from);
        }
    }
}

fn write_picture(
    arguments: &Arguments,
    counts: &Counts,
    path: Option<&Path>,
    interrupt: &Interrupt,
) -> Result<(), Failure> {
    let mut still = Still { size: counts.size, pixels: colored(counts, &coloring(arguments)) };
    let mut how = arguments.shown.interactive.clone();
    how.output = path.map(Path::to_owned);
    interactive::run(&mut still, "lab-8", &how, interrupt)
}

/// `name-007.png` for `name.png`, with as many digits as `count` pictures need, at least three.
pub(super) fn numbered(path: &Path, i: usize, count: usize) -> PathBuf {
    let digits = (count.saturating_sub(1)).to_string().len().max(3);
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let extension = path.extension().map_or_else(|| "png".into(), |e| e.to_string_lossy().into_owned());
    path.with_file_name(format!("{stem}-{i:0digits$}.{extension}"))
}

fn write_zoom(arguments: &Arguments, last: &Picture, frames: usize) -> Result<(), Failure> {
    let interrupt = Interrupt::listen();
    let from: Wide =
        View::parse("0", "0", &arguments.from_width).map_err(|e: LabError| usage("--from-width", &e))?.width;
    let Some(output) = &arguments.shown.interactive.output else { return Ok(()) };
    for (i, width) in zoom_widths(from, last.view.width, frames).into_iter().enumerate() {
        let view = View { width, ..last.view.clone() };
        let job = Job::View(Picture { view, ..last.clone() });
        let counts = computed(arguments, &job, &interrupt)?;
        write_picture(arguments, &counts, Some(&numbered(output, i, frames)), &interrupt)?;
    }
    Ok(())
}
