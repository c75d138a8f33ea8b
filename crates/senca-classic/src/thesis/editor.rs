//! The look-up table editor (1991 thesis, section 12.3): one line in, some lines out.
//!
//! | letter | what it does |
//! |---|---|
//! | R | computes the table from the profile and sets it: the picture changes its colours |
//! | V | changes one node: its number, then R G B X |
//! | P | changes the whole profile: number of nodes, then R G B X of each |
//! | B | background: R G B |
//! | L | loads a bitmap and shows it |
//! | X | ends |
//! | H | explains |
//!
//! Five letters are new: C exchanges RGB and HLS, in which colours are then typed and mixed; M and E
//! set the grey palette of a VAX and that of EGA and VGA; S saves the picture, W writes the profile.
//!
//! The program let one type what would not work: fewer than two nodes, nodes out of order (which
//! divided by zero), a background beyond white, any node number. Here such answers are asked for
//! again, or refused with a reason; [`LutEditor::as_printed`] takes them.

use std::fmt::Write;

use senca_io::classic::IndexBitmap;
use senca_math::Hls;
use senca_window::Canvas;

use super::lut::{ColorModel, Lut, paint};
use super::profile::{MAX_NODES, Node, Profile};

/// Size of the picture before a bitmap is loaded.
const VIEWPORT: u32 = 50;

/// Files for the editor. Errors are told to the user as they are.
pub trait EditorFiles {
    /// Reads a bitmap of colour indices.
    ///
    /// # Errors
    /// What the user is told.
    fn load_bitmap(&mut self, name: &str) -> Result<IndexBitmap, String>;

    /// Writes a picture.
    ///
    /// # Errors
    /// What the user is told.
    fn save_picture(&mut self, name: &str, picture: &Canvas) -> Result<(), String>;

    /// Writes a profile file.
    ///
    /// # Errors
    /// What the user is told.
    fn save_profile(&mut self, name: &str, text: &str) -> Result<(), String>;
}

/// What the editor answers.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct EditorReply {
    /// For the user; empty or with a line end.
    pub text: String,
    /// Whether the picture has changed.
    pub redraw: bool,
    /// Whether the editor has ended.
    pub exit: bool,
}

/// What the next line is an answer to.
#[derive(Clone, Debug, PartialEq)]
enum Question {
    Command,
    Count,
    Which,
    /// R G B X of a node, and whether the next one's follow.
    Node(usize, bool),
    Background,
    Name(NameOf),
}

/// Whose name is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum NameOf {
    Bitmap,
    Picture,
    Profile,
}

/// The editor with its picture, profile and table.
#[derive(Clone, Debug, PartialEq)]
pub struct LutEditor {
    bitmap: IndexBitmap,
    profile: Profile,
    lut: Lut,
    question: Question,
    as_printed: bool,
}

impl LutEditor {
    /// An editor for a device of so many colours, which begins with greys and the default profile.
    #[must_use]
    pub fn new(colors: u32) -> Self {
        let lut = Lut::mono(colors.max(2));
        let side = VIEWPORT as usize;
        let bitmap = IndexBitmap { width: VIEWPORT, height: VIEWPORT, indices: vec![0; side * side] };
        Self { bitmap, profile: Profile::default(), lut, question: Question::Command, as_printed: false }
    }

    /// The same, taking what the listing takes and computing the table as it does.
    #[must_use]
    pub fn as_printed(mut self) -> Self {
        self.as_printed = true;
        self
    }

    /// With a picture to begin with.
    #[must_use]
    pub fn with_bitmap(mut self, bitmap: IndexBitmap) -> Self {
        self.bitmap = bitmap;
        self
    }

    /// With a profile to begin with, which the table shows.
    #[must_use]
    pub fn with_profile(mut self, profile: Profile) -> Self {
        self.profile = profile;
        self.recompute();
        self
    }

    /// The picture's colour indices.
    #[must_use]
    pub fn bitmap(&self) -> &IndexBitmap {
        &self.bitmap
    }

    /// The table that the device shows.
    #[must_use]
    pub fn lut(&self) -> &Lut {
        &self.lut
    }

    /// The profile as it was edited; the table has it after R.
    #[must_use]
    pub fn profile(&self) -> &Profile {
        &self.profile
    }

    /// Gives a node another colour or place, kept within 0 and 1 and between its neighbours, and
    /// recomputes the table. Nodes that there are not are passed over.
    pub fn set_node(&mut self, number: usize, node: Node) {
        let x_of = |number: usize| self.profile.nodes.get(number).map(|node| node.x);
        let least = number.checked_sub(1).and_then(x_of).unwrap_or(0.0);
        let greatest = x_of(number + 1).unwrap_or(1.0);
        if let Some(place) = self.profile.nodes.get_mut(number) {
            let x = node.x.max(least).min(greatest);
            *place = Node { rgb: node.rgb.map(|part| part.clamp(0.0, 1.0)), x };
            self.recompute();
        }
    }

    /// The picture in its colours.
    #[must_use]
    pub fn picture(&self) -> Canvas {
        paint(&self.bitmap, &self.lut)
    }

    /// What a program prints when it begins.
    #[must_use]
    pub fn greeting(&self) -> String {
        format!("Number of colours: {}\n", self.lut.colors.len())
    }

    /// Whether a command is expected, a single letter.
    #[must_use]
    pub fn expects_command(&self) -> bool {
        self.question == Question::Command
    }

    /// The editor with its question forgotten: a command is expected.
    #[must_use]
    pub fn asked_nothing(mut self) -> Self {
        self.question = Question::Command;
        self
    }

    /// What is asked; before a command the nodes are listed too.
    #[must_use]
    pub fn prompt(&self) -> String {
        match self.question {
            Question::Command => format!("{}[R,V,P,B,L,C,M,E,S,W,X,Help]: ", self.listing()),
            _ => self.short_prompt(),
        }
    }

    /// What is asked, in one line.
    #[must_use]
    pub fn short_prompt(&self) -> String {
        let parts = if self.profile.model == ColorModel::Hls { "H/360 L S" } else { "R G B" };
        match self.question {
            Question::Command => "[R,V,P,B,L,C,M,E,S,W,X,Help]: ".to_owned(),
            Question::Count => "Number of nodes: ".to_owned(),
            Question::Which => "Node number: ".to_owned(),
            Question::Node(number, _) => format!("Node {number}, {parts} X: "),
            Question::Background => format!("Background, {parts}: "),
            Question::Name(NameOf::Bitmap) => "Bitmap: ".to_owned(),
            Question::Name(NameOf::Picture) => "Picture to write: ".to_owned(),
            Question::Name(NameOf::Profile) => "Profile to write: ".to_owned(),
        }
    }

    fn listing(&self) -> String {
        let mut text = format!("Nodes: {}\n", self.profile.nodes.len());
        for (number, Node { rgb, x }) in self.profile.nodes.iter().enumerate() {
            let [r, g, b] = rgb;
            let _ = writeln!(text, "{number:2}  X {x:.2}  R {r:.2}  G {g:.2}  B {b:.2}");
        }
        text
    }

    /// Takes the user's next line.
    pub fn line(&mut self, line: &str, files: &mut dyn EditorFiles) -> EditorReply {
        let line = line.trim();
        match self.question.clone() {
            Question::Command => self.command(line),
            Question::Count => self.count(line),
            Question::Which => self.which(line),
            Question::Node(number, more) => self.node(line, number, more),
            Question::Background => self.background(line),
            Question::Name(of) => {
                self.question = Question::Command;
                if line.is_empty() { EditorReply::default() } else { self.file(of, line, files) }
            }
        }
    }

    fn command(&mut self, line: &str) -> EditorReply {
        let letter = line.chars().next().map(|letter| letter.to_ascii_uppercase());
        let next = match letter {
            Some('R') => return self.set_table(),
            Some('C') => {
                self.profile.model = match self.profile.model {
                    ColorModel::Rgb => ColorModel::Hls,
                    ColorModel::Hls => ColorModel::Rgb,
                };
                return say(format!("Colours are {:?}\n", self.profile.model));
            }
            Some('M') => return self.palette(Lut::greys(self.lut.colors.len() as u32)),
            Some('E') => return self.palette(Lut::ega(self.lut.colors.len() as u32)),
            Some('H') => return say(HELP.to_owned()),
            Some('X') => return EditorReply { exit: true, ..EditorReply::default() },
            Some('V') => Question::Which,
            Some('P') => Question::Count,
            Some('B') => Question::Background,
            Some('L') => Question::Name(NameOf::Bitmap),
            Some('S') => Question::Name(NameOf::Picture),
            Some('W') => Question::Name(NameOf::Profile),
            _ => return say("What?\n".to_owned()),
        };
        self.question = next;
        EditorReply::default()
    }

    fn set_table(&mut self) -> EditorReply {
        if let Err(error) = self.profile.check()
            && !self.as_printed
        {
            return say(format!("The profile cannot be used: {error}\n"));
        }
        self.recompute();
        EditorReply { redraw: true, ..EditorReply::default() }
    }

    fn recompute(&mut self) {
        if self.as_printed {
            self.lut.set_profile_as_printed(&self.profile);
        } else {
            self.lut.set_profile(&self.profile);
        }
    }

    fn palette(&mut self, palette: Result<Lut, super::PaletteError>) -> EditorReply {
        match palette {
            Ok(lut) => {
                self.lut = lut;
                EditorReply { redraw: true, ..EditorReply::default() }
            }
            Err(error) => say(format!("{error}\n")),
        }
    }

    fn count(&mut self, line: &str) -> EditorReply {
        let Ok(count) = line.parse::<usize>() else { return self.again() };
        if count > MAX_NODES || count < 2 && !self.as_printed {
            return say(format!("There must be 2 to {MAX_NODES} nodes\n"));
        }
        self.profile.nodes.resize(count, Node { rgb: [1.0; 3], x: 1.0 });
        self.question = if count == 0 { Question::Command } else { Question::Node(0, true) };
        if count < 2 { say("There must be at least 2 nodes\n".to_owned()) } else { EditorReply::default() }
    }

    fn which(&mut self, line: &str) -> EditorReply {
        self.question = Question::Command;
        let Ok(number) = line.parse::<usize>() else { return EditorReply::default() };
        if number < self.profile.nodes.len() {
            self.question = Question::Node(number, false);
            return EditorReply::default();
        }
        if self.as_printed {
            return EditorReply::default();
        }
        say(format!("There is no node {number}\n"))
    }

    fn node(&mut self, line: &str, number: usize, more: bool) -> EditorReply {
        let Some([a, b, c, x]) = numbers(line, true) else { return self.again() };
        let rgb = self.rgb([a, b, c]);
        if let Some(node) = self.profile.nodes.get_mut(number) {
            *node = Node { rgb, x };
        }
        let another = more && number + 1 < self.profile.nodes.len();
        self.question = if another { Question::Node(number + 1, true) } else { Question::Command };
        EditorReply::default()
    }

    fn background(&mut self, line: &str) -> EditorReply {
        let Some(color) = numbers(line, !self.as_printed) else { return self.again() };
        self.profile.background = self.rgb(color);
        self.question = Question::Command;
        EditorReply::default()
    }

    /// A colour as it was typed; hue is a share of the circle.
    fn rgb(&self, [a, b, c]: [f64; 3]) -> [f64; 3] {
        match self.profile.model {
            ColorModel::Rgb => [a, b, c],
            ColorModel::Hls => Hls::new(a * 360.0, b, c).to_rgb(),
        }
    }

    /// The same question once more.
    fn again(&self) -> EditorReply {
        let what = match self.question {
            Question::Node(..) => "Four numbers from 0 to 1, please\n",
            Question::Background => "Three numbers from 0 to 1, please\n",
            _ => "A whole number, please\n",
        };
        say(what.to_owned())
    }

    fn file(&mut self, of: NameOf, name: &str, files: &mut dyn EditorFiles) -> EditorReply {
        let done = match of {
            NameOf::Bitmap => files.load_bitmap(name).map(|bitmap| self.bitmap = bitmap),
            NameOf::Picture => files.save_picture(name, &self.picture()),
            NameOf::Profile => files.save_profile(name, &self.profile.text()),
        };
        match done {
            Ok(()) => EditorReply { redraw: of == NameOf::Bitmap, ..EditorReply::default() },
            Err(message) => say(format!("{message}\n")),
        }
    }
}

fn say(text: String) -> EditorReply {
    EditorReply { text, ..EditorReply::default() }
}

/// Exactly `N` numbers, finite, and from 0 to 1 if that is asked.
fn numbers<const N: usize>(line: &str, within: bool) -> Option<[f64; N]> {
    let numbers: Result<Vec<f64>, _> =
        line.split([' ', '\t', ',']).filter(|w| !w.is_empty()).map(str::parse).collect();
    let numbers = <[f64; N]>::try_from(numbers.ok()?).ok()?;
    let good = |n: &f64| n.is_finite() && (!within || (0.0..=1.0).contains(n));
    numbers.iter().all(good).then_some(numbers)
}

/// The answer to H.
const HELP: &str = "\
R  recompute the table from the profile and set it
V  change one node: its number, then its colour and X (the cosine between normal and light)
P  change the profile: number of nodes, then all of them
B  background
L  load a bitmap and show it
C  colours are typed and mixed as RGB or as HLS
M  greys    E  the palette of EGA and VGA
S  save the picture    W  write the profile
H  this    X  exit
";

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use super::*;

    #[derive(Default)]
    struct Memory {
        pictures: HashMap<String, Canvas>,
        profiles: HashMap<String, String>,
    }

    impl EditorFiles for Memory {
        fn load_bitmap(&mut self, name: &str) -> Result<IndexBitmap, String> {
            match name {
                "two.btm" => Ok(IndexBitmap { width: 1, height: 2, indices: vec![0, 15] }),
                _ => Err(format!("{name}: not found")),
            }
        }
        fn save_picture(&mut self, name: &str, picture: &Canvas) -> Result<(), String> {
            self.pictures.insert(name.to_owned(), picture.clone());
            Ok(())
        }
        fn save_profile(&mut self, name: &str, text: &str) -> Result<(), String> {
            self.profiles.insert(name.to_owned(), text.to_owned());
            Ok(())
        }
    }

    fn type_in(editor: &mut LutEditor, lines: &[&str], files: &mut Memory) -> Vec<EditorReply> {
        lines.iter().map(|line| editor.line(line, files)).collect()
    }

    #[test]
    fn a_session_recolours_the_picture() {
        let (mut editor, mut files) = (LutEditor::new(16), Memory::default());
        assert_eq!(editor.greeting(), "Number of colours: 16\n");
        assert_eq!((editor.bitmap().width, editor.bitmap().height), (50, 50));
        assert_eq!(
            editor.prompt(),
            "Nodes: 2\n 0  X 0.00  R 0.00  G 0.10  B 0.00\n 1  X 1.00  R 0.00  G 1.00  B 0.00\n[R,V,P,B,L,C,M,E,S,W,X,Help]: "
        );
        let replies = type_in(&mut editor, &["l", "two.btm"], &mut files);
        assert!(replies[1].redraw);
        assert_eq!(editor.picture().pixels(), [0, 0xef_efef], "greys: 15 of 16 parts");
        assert!(type_in(&mut editor, &["R"], &mut files)[0].redraw);
        assert_eq!(editor.picture().pixels(), [0xff_ffff, 0xff00]);
        type_in(&mut editor, &["b", "0 0 1", "v", "1", "1 0.5 0 1"], &mut files);
        assert_eq!(editor.picture().pixels(), [0xff_ffff, 0xff00], "nothing changes before R");
        type_in(&mut editor, &["r", "s", "a.png", "w", "a.lut"], &mut files);
        assert_eq!(files.pictures["a.png"].pixels(), [0xff, 0xff_8000]);
        assert_eq!(files.profiles["a.lut"], "background 0 0 1\nnode 0 0.1 0 0\nnode 1 0.5 0 1\n");
        assert!(type_in(&mut editor, &["x"], &mut files)[0].exit);
    }

    #[test]
    fn a_whole_profile_is_asked_for_node_by_node() {
        let (mut editor, mut files) = (LutEditor::new(16), Memory::default());
        type_in(&mut editor, &["P", "3", "0 0 0 0"], &mut files);
        assert_eq!(editor.prompt(), "Node 1, R G B X: ");
        let replies = type_in(&mut editor, &["1 2 3 4", "0.5 0.5", "1 0 0 0.8", "1 1 1 1"], &mut files);
        assert_eq!(replies[0].text, "Four numbers from 0 to 1, please\n");
        assert_eq!(replies[1].text, replies[0].text);
        assert!(editor.expects_command());
        assert_eq!(editor.profile().nodes.len(), 3);
        assert_eq!(editor.profile().nodes[1], Node { rgb: [1.0, 0.0, 0.0], x: 0.8 });
    }

    #[test]
    fn what_would_not_work_is_refused() {
        let (mut editor, mut files) = (LutEditor::new(16), Memory::default());
        let told = |replies: Vec<EditorReply>| replies.last().map(|r| r.text.clone()).unwrap_or_default();
        assert_eq!(told(type_in(&mut editor, &["?"], &mut files)), "What?\n");
        assert_eq!(told(type_in(&mut editor, &[""], &mut files)), "What?\n");
        assert_eq!(told(type_in(&mut editor, &["p", "1"], &mut files)), "There must be 2 to 20 nodes\n");
        assert_eq!(told(type_in(&mut editor, &["many"], &mut files)), "A whole number, please\n");
        type_in(&mut editor, &["2", "0 0 0 1", "1 1 1 0"], &mut files);
        let refused = told(type_in(&mut editor, &["r"], &mut files));
        assert_eq!(refused, "The profile cannot be used: node 1 must not come before node 0\n");
        assert_eq!(told(type_in(&mut editor, &["v", "2"], &mut files)), "There is no node 2\n");
        assert_eq!(told(type_in(&mut editor, &["l", "no.btm"], &mut files)), "no.btm: not found\n");
        assert!(told(type_in(&mut editor, &["b", "2 0 0"], &mut files)).starts_with("Three numbers"));
        assert_eq!(told(type_in(&mut editor, &["0 0 0", "e"], &mut files)), "");
        assert_eq!(editor.lut(), &Lut::ega(16).expect("a palette"));
        type_in(&mut editor, &["m"], &mut files);
        assert_eq!(editor.lut(), &Lut::greys(16).expect("greys"));
        let mut wide = LutEditor::new(256);
        assert!(told(type_in(&mut wide, &["e"], &mut files)).contains("not EGA or VGA"));
        assert!(told(type_in(&mut editor, &["H"], &mut files)).contains("recompute the table"));
    }

    #[test]
    fn the_listing_takes_what_would_not_work() {
        let (mut editor, mut files) = (LutEditor::new(16).as_printed(), Memory::default());
        let replies = type_in(&mut editor, &["p", "1", "0 0 0 0", "r"], &mut files);
        assert_eq!(replies[1].text, "There must be at least 2 nodes\n");
        assert_eq!(editor.profile().nodes.len(), 1);
        type_in(&mut editor, &["b", "9 -1 0", "r", "p", "2", "0 0 0 0.5", "1 1 1 0.5", "r"], &mut files);
        assert_eq!(editor.lut().pixel(0), 0xff_0000);
        assert_eq!(editor.lut().pixel(8), 0, "equal x divide by zero");
    }

    #[test]
    fn colours_are_typed_in_hue_lightness_and_saturation() {
        let (mut editor, mut files) = (LutEditor::new(16), Memory::default());
        let reply = type_in(&mut editor, &["c"], &mut files);
        assert_eq!(reply[0].text, "Colours are Hls\n");
        type_in(&mut editor, &["v", "1"], &mut files);
        assert_eq!(editor.prompt(), "Node 1, H/360 L S X: ");
        type_in(&mut editor, &["0.583333333 0.4 0.5 1"], &mut files);
        let rgb = editor.profile().nodes[1].rgb;
        assert!(rgb.iter().zip([0.2, 0.4, 0.6]).all(|(a, b)| (a - b).abs() < 1e-8), "{rgb:?}");
    }

    #[test]
    fn dragged_nodes_stay_between_their_neighbours() {
        let mut editor = LutEditor::new(16);
        editor.set_node(0, Node { rgb: [2.0, -1.0, 0.5], x: 7.0 });
        assert_eq!(editor.profile().nodes[0], Node { rgb: [1.0, 0.0, 0.5], x: 1.0 });
        editor.set_node(1, Node { rgb: [0.0; 3], x: -3.0 });
        assert_eq!(editor.profile().nodes[1].x, 1.0);
        editor.set_node(9, Node::default());
    }
}
