//! The look-up table editor in a window: the picture above, its profile and table below.
//!
//! Keys are the editor's commands; what it asks stands in the title, answers are typed and end with
//! Enter, Escape gives up. In the profile, nodes of the three colours can be dragged: up and down the
//! colour, sideways the whole node; the right button removes a node, and a click beside all of them
//! makes one. The picture follows at once, since only the table changes.

use senca_window::{Button, Canvas, Event, Flow, Key, Program};

use super::editor::{EditorFiles, LutEditor};
use super::lut::paint;
use super::profile::{MAX_NODES, Node};

/// Height of the profile with its table, in pixels.
const PANEL: usize = 120;
/// Height of the bar that shows the table.
const BAR: usize = 16;
/// Least width of the window.
const LEAST_WIDTH: usize = 300;
/// Space around the curves.
const MARGIN: usize = 8;
/// Reach of the mouse around a node, in pixels.
const REACH: i32 = 6;
/// Background of the panel, lines of its frame.
const PAPER: u32 = 0x20_2020;
const FRAME: u32 = 0x60_6060;
/// Colours of the three curves.
const CURVES: [u32; 3] = [0xff_5050, 0x50_ff50, 0x70_90ff];

/// The editor as an interactive program.
pub struct LutWindow {
    editor: LutEditor,
    files: Box<dyn EditorFiles>,
    typed: String,
    told: String,
    size: (usize, usize),
    /// Node and colour under the pressed mouse.
    held: Option<(usize, usize)>,
}

impl LutWindow {
    /// A window around an editor.
    #[must_use]
    pub fn new(editor: LutEditor, files: Box<dyn EditorFiles>) -> Self {
        let told = "Lut".to_owned();
        let mut window = Self { editor, files, typed: String::new(), told, size: (0, 0), held: None };
        window.size = window.size();
        window
    }

    /// The editor as it is now.
    #[must_use]
    pub fn editor(&self) -> &LutEditor {
        &self.editor
    }

    fn key(&mut self, key: Key) -> Flow {
        match key {
            Key::Escape if self.editor.expects_command() => return Flow::Quit,
            Key::Escape => {
                let fresh = self.editor.clone().asked_nothing();
                self.editor = fresh;
                self.typed.clear();
            }
            Key::Backspace => _ = self.typed.pop(),
            Key::Enter => return self.enter(),
            Key::Char(letter) if self.editor.expects_command() => {
                self.typed = letter.to_string();
                return self.enter();
            }
            Key::Char(letter) if self.typed.len() < 200 => self.typed.push(letter),
            _ => return Flow::Wait,
        }
        Flow::Redraw
    }

    fn enter(&mut self) -> Flow {
        let line = std::mem::take(&mut self.typed);
        let reply = self.editor.line(&line, self.files.as_mut());
        self.told = reply.text.lines().next().unwrap_or("Lut").to_owned();
        if reply.exit { Flow::Quit } else { Flow::Redraw }
    }

    /// The rectangle of the curves: left, top, width and height less one.
    fn graph(&self) -> [i32; 4] {
        let (width, height) = self.size;
        let top = height.saturating_sub(PANEL) + MARGIN;
        let graph = [MARGIN, top, width.saturating_sub(2 * MARGIN + 1).max(1), PANEL - 3 * MARGIN - BAR - 1];
        graph.map(|n| n as i32)
    }

    fn place(&self, node: &Node, part: usize) -> (i32, i32) {
        let [left, top, width, height] = self.graph();
        let x = left + (node.x * f64::from(width)).round() as i32;
        (x, top + ((1.0 - node.rgb[part]) * f64::from(height)).round() as i32)
    }

    /// Cosine and colour at a place of the window.
    fn value(&self, x: i32, y: i32) -> (f64, f64) {
        let [left, top, width, height] = self.graph();
        let share = |n: i32, of: i32| (f64::from(n) / f64::from(of)).clamp(0.0, 1.0);
        (share(x.saturating_sub(left), width), 1.0 - share(y.saturating_sub(top), height))
    }

    /// The nearest node and colour within reach.
    fn at(&self, x: i32, y: i32) -> Option<(usize, usize)> {
        let nodes = self.editor.profile().nodes.iter().enumerate();
        let all = nodes.flat_map(|(number, node)| (0..3).map(move |part| (number, part, *node)));
        let distance = |&(_, part, node): &(usize, usize, Node)| {
            let (nx, ny) = self.place(&node, part);
            nx.abs_diff(x).max(ny.abs_diff(y))
        };
        let nearest = all.min_by_key(distance)?;
        (distance(&nearest) <= REACH as u32).then_some((nearest.0, nearest.1))
    }

    fn press(&mut self, button: Button, x: i32, y: i32) -> Flow {
        let found = self.at(x, y);
        let [_, top, _, height] = self.graph();
        let inside = (top - REACH..=top + height + REACH).contains(&y);
        match (button, found) {
            (Button::Left, Some(_)) => self.held = found,
            (Button::Left, None) if inside => self.held = self.add_node(x, y),
            (Button::Right, Some((number, _))) => self.remove_node(number),
            _ => return Flow::Wait,
        }
        Flow::Redraw
    }

    /// A new node on the curves at this cosine, held by the colour that is nearest.
    fn add_node(&mut self, x: i32, y: i32) -> Option<(usize, usize)> {
        let (cosine, value) = self.value(x, y);
        let mut profile = self.editor.profile().clone();
        if profile.nodes.len() >= MAX_NODES {
            return None;
        }
        let node = Node { rgb: profile.color(cosine), x: cosine };
        let number = profile.nodes.iter().position(|n| n.x > cosine).unwrap_or(profile.nodes.len());
        profile.nodes.insert(number, node);
        self.editor = self.editor.clone().with_profile(profile);
        let apart = |part: &usize| ((node.rgb[*part] - value).abs() * 1e6) as u64;
        (0..3).min_by_key(apart).map(|part| (number, part))
    }

    fn remove_node(&mut self, number: usize) {
        let mut profile = self.editor.profile().clone();
        if profile.nodes.len() > 2 {
            profile.nodes.remove(number);
            self.editor = self.editor.clone().with_profile(profile);
        }
    }

    fn drag(&mut self, x: i32, y: i32) -> Flow {
        let Some((number, part)) = self.held else { return Flow::Wait };
        let Some(mut node) = self.editor.profile().nodes.get(number).copied() else { return Flow::Wait };
        let (cosine, value) = self.value(x, y);
        node.rgb[part] = value;
        // The first and last node keep their places at the ends.
        let end = number == 0 || number + 1 == self.editor.profile().nodes.len();
        if !end {
            node.x = cosine;
        }
        self.editor.set_node(number, node);
        Flow::Redraw
    }

    fn draw_picture(&self, canvas: &mut Canvas) {
        let picture = paint(self.editor.bitmap(), self.editor.lut());
        let (room, height) = (canvas.width(), canvas.height().saturating_sub(PANEL));
        let scale = (room / picture.width().max(1)).min(height / picture.height().max(1)).max(1);
        let offset = (
            room.saturating_sub(scale * picture.width()) / 2,
            height.saturating_sub(scale * picture.height()) / 2,
        );
        let background = self.editor.lut().pixel(0);
        for y in 0..height {
            for x in 0..room {
                let at = |n: usize, offset: usize| n.checked_sub(offset).map_or(-1, |n| (n / scale) as i32);
                let color = picture.get(at(x, offset.0), at(y, offset.1)).unwrap_or(background);
                canvas.set(x as i32, y as i32, color);
            }
        }
    }

    fn draw_panel(&self, canvas: &mut Canvas) {
        let (width, height) = (canvas.width(), canvas.height());
        let top = height.saturating_sub(PANEL);
        for y in top..height {
            (0..width).for_each(|x| canvas.set(x as i32, y as i32, PAPER));
        }
        let [left, graph_top, graph_width, graph_height] = self.graph();
        for x in 0..=graph_width {
            canvas.set(left + x, graph_top, FRAME);
            canvas.set(left + x, graph_top + graph_height, FRAME);
            let color = self.editor.profile().color(f64::from(x) / f64::from(graph_width));
            for part in 0..3 {
                let y = graph_top + ((1.0 - color[part]) * f64::from(graph_height)).round() as i32;
                canvas.set(left + x, y, CURVES[part]);
            }
            self.draw_bar(canvas, left + x, f64::from(x) / f64::from(graph_width));
        }
        for node in &self.editor.profile().nodes {
            for (part, &color) in CURVES.iter().enumerate() {
                let (x, y) = self.place(node, part);
                for d in -2..=2 {
                    for e in -2..=2 {
                        canvas.set(x + d, y + e, color);
                    }
                }
            }
        }
    }

    /// A column of the bar with the table's colours.
    fn draw_bar(&self, canvas: &mut Canvas, x: i32, share: f64) {
        let colors = self.editor.lut().colors.len();
        let index = ((share * colors as f64) as usize).min(colors - 1);
        let color = self.editor.lut().pixel(index as u32);
        let top = canvas.height().saturating_sub(BAR + MARGIN) as i32;
        (0..BAR as i32).for_each(|y| canvas.set(x, top + y, color));
    }
}

impl Program for LutWindow {
    fn title(&self) -> String {
        format!("{} - {}{}", self.told, self.editor.short_prompt(), self.typed)
    }

    fn size(&self) -> (usize, usize) {
        let bitmap = self.editor.bitmap();
        ((bitmap.width as usize).max(LEAST_WIDTH), (bitmap.height as usize).max(100) + PANEL)
    }

    fn event(&mut self, event: Event) -> Flow {
        match event {
            Event::KeyDown(key) => self.key(key),
            Event::Press(button, x, y) => self.press(button, x, y),
            Event::Move(x, y) => self.drag(x, y),
            Event::Release(..) => {
                self.held = None;
                Flow::Wait
            }
            Event::Resize(width, height) => {
                self.size = (width, height);
                Flow::Redraw
            }
            _ => Flow::Wait,
        }
    }

    fn draw(&mut self, canvas: &mut Canvas) {
        self.size = (canvas.width(), canvas.height());
        self.draw_picture(canvas);
        self.draw_panel(canvas);
    }
}

#[cfg(test)]
mod tests {
    use senca_io::classic::IndexBitmap;

    use super::*;

    struct NoFiles;

    impl EditorFiles for NoFiles {
        fn load_bitmap(&mut self, name: &str) -> Result<IndexBitmap, String> {
            Err(format!("{name}: no files here"))
        }
        fn save_picture(&mut self, _: &str, _: &Canvas) -> Result<(), String> {
            Ok(())
        }
        fn save_profile(&mut self, _: &str, _: &str) -> Result<(), String> {
            Ok(())
        }
    }

    fn window() -> LutWindow {
        let bitmap = IndexBitmap { width: 300, height: 100, indices: vec![15; 30_000] };
        LutWindow::new(LutEditor::new(16).with_bitmap(bitmap), Box::new(NoFiles))
    }

    fn type_in(window: &mut LutWindow, text: &str) {
        for letter in text.chars() {
            let key = if letter == '\n' { Key::Enter } else { Key::Char(letter) };
            window.event(Event::KeyDown(key));
        }
    }

    fn drawn(window: &mut LutWindow) -> Canvas {
        let (width, height) = window.size();
        let mut canvas = Canvas::new(width, height);
        window.draw(&mut canvas);
        canvas
    }

    #[test]
    fn keys_are_the_commands() {
        let mut window = window();
        assert_eq!(window.size(), (300, 220));
        assert_eq!(drawn(&mut window).get(150, 50), Some(0xef_efef));
        type_in(&mut window, "r");
        assert_eq!(drawn(&mut window).get(150, 50), Some(0xff00));
        type_in(&mut window, "v1\n1 0 0 1");
        assert_eq!(window.title(), "Lut - Node 1, R G B X: 1 0 0 1");
        type_in(&mut window, "\nr");
        assert_eq!(drawn(&mut window).get(150, 50), Some(0xff_0000));
        type_in(&mut window, "lx.btm\n");
        assert!(window.title().starts_with("x.btm: no files here - "));
        type_in(&mut window, "b1 1");
        window.event(Event::KeyDown(Key::Backspace));
        assert!(window.title().ends_with("Background, R G B: 1 "));
        assert_eq!(window.event(Event::KeyDown(Key::Escape)), Flow::Redraw);
        assert!(window.editor().expects_command());
        assert_eq!(window.event(Event::KeyDown(Key::Char('x'))), Flow::Quit);
    }

    #[test]
    fn nodes_are_dragged_made_and_removed() {
        let mut window = window();
        drawn(&mut window);
        let [left, top, width, height] = window.graph();
        // The last node's green stands on top on the right: drag it half way down.
        window.event(Event::Press(Button::Left, left + width, top));
        window.event(Event::Move(left + width - 40, top + height / 2));
        window.event(Event::Release(Button::Left, 0, 0));
        let node = window.editor().profile().nodes[1];
        assert!(node.x == 1.0 && (node.rgb[1] - 0.5).abs() < 0.02, "{node:?}");
        assert_eq!(window.event(Event::Move(left, top)), Flow::Wait);
        // A new node in the middle, pulled up.
        window.event(Event::Press(Button::Left, left + width / 2, top + height / 4));
        window.event(Event::Move(left + width / 2, top));
        window.event(Event::Release(Button::Left, 0, 0));
        assert_eq!(window.editor().profile().nodes.len(), 3);
        assert_eq!(window.editor().profile().nodes[1].rgb[1], 1.0);
        let canvas = drawn(&mut window);
        assert_eq!(canvas.get(left + width / 2, top), Some(CURVES[1]));
        window.event(Event::Press(Button::Right, left + width / 2, top));
        assert_eq!(window.editor().profile().nodes.len(), 2);
        window.event(Event::Press(Button::Right, left, top + height));
        assert_eq!(window.editor().profile().nodes.len(), 2, "two remain");
    }

    #[test]
    fn any_size_can_be_drawn() {
        let mut window = window();
        for (width, height) in [(1, 1), (10, 500), (900, 30), (1000, 700)] {
            window.event(Event::Resize(width, height));
            let mut canvas = Canvas::new(width, height);
            window.draw(&mut canvas);
            window.event(Event::Press(Button::Left, i32::MAX, i32::MIN));
            window.event(Event::Press(Button::Left, 0, height as i32 - 60));
            window.event(Event::Move(i32::MIN, i32::MAX));
            window.event(Event::Release(Button::Left, 0, 0));
        }
    }
}
