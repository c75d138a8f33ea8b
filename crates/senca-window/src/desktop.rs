//! Programs in a window of the desktop, by X11, Wayland, Windows or macOS, without a GPU.
//!
//! The canvas has the pixels of the window: on a display of high density the window is opened as large as it
//! would be on a plain one, and the program told by [`Event::Resize`] how many pixels that is.
//!
//! The program is drawn when it wanted to be and the window shows it; several events may come before that. An
//! animated program gets a tick of the time gone since the last one, at most 60 times a second. Ctrl+S saves
//! the picture; the window's own button closes it.

use crate::{Button, Canvas, Event, Key, Program, Session};
use softbuffer::{Context, Surface};
use std::collections::{HashMap, HashSet};
use std::num::NonZeroU32;
use std::rc::Rc;
use std::time::{Duration, Instant};
use winit::application::ApplicationHandler;
use winit::dpi::{LogicalSize, PhysicalSize};
use winit::error::EventLoopError;
use winit::event::{ElementState, KeyEvent, MouseButton, MouseScrollDelta, StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop};
use winit::keyboard::{Key as WindowKey, ModifiersState, NamedKey, PhysicalKey};
use winit::window::{Window, WindowId};

/// Time between ticks.
const FRAME: Duration = Duration::from_micros(16_667);

/// Longest tick in seconds: a computer that slept has not run meanwhile.
const LONGEST_TICK: f64 = 1.0;

/// Pixels of a wheel that scrolls smoothly, for one notch.
const PIXELS_PER_NOTCH: f64 = 40.0;

/// Why there is no window.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DesktopError {
    /// There is no desktop, or none that can be reached.
    #[error("there is no display to open a window on: {0}")]
    NoDisplay(String),
    /// The desktop gives no window.
    #[error("the window cannot be opened: {0}")]
    Window(String),
    /// The desktop does not take the picture.
    #[error("the window cannot be drawn: {0}")]
    Picture(String),
}

/// Runs a program in a window until it ends or the window is closed; returns the last picture. `save` gets the
/// picture each time that the user presses Ctrl+S.
///
/// Has to be called from the main thread; some desktops allow it only once in a process.
///
/// # Errors
/// When there is no display, or it gives no window.
pub fn run(program: &mut dyn Program, save: impl FnMut(&Canvas)) -> Result<Canvas, DesktopError> {
    go_on(Session::new(program), save)
}

/// Goes on in a window with a session that has begun, as [`run`] does.
///
/// # Errors
/// When there is no display, or it gives no window.
pub fn go_on(mut session: Session<'_>, save: impl FnMut(&Canvas)) -> Result<Canvas, DesktopError> {
    let events = EventLoop::new().map_err(|error| DesktopError::NoDisplay(plain(&error)))?;
    session.enter_window();
    let mut desktop = Desktop {
        session,
        save,
        shown: None,
        input: Input::default(),
        last_tick: Instant::now(),
        error: None,
    };
    let ran = events.run_app(&mut desktop);
    // The window goes before the connection to the display does.
    drop(desktop.shown);
    match (desktop.error, ran) {
        (Some(error), _) => Err(error),
        (None, Err(error)) => Err(DesktopError::Window(error.to_string())),
        (None, Ok(())) => Ok(desktop.session.finish()),
    }
}

/// What the system says, without the place in the source code of the library that tells it.
fn plain(error: &EventLoopError) -> String {
    match error {
        EventLoopError::Os(error) => {
            let text = error.to_string();
            text.rsplit_once(": ").map_or(text.clone(), |(_, what)| what.to_owned())
        }
        other => other.to_string(),
    }
}

/// A program in its window.
struct Desktop<'a, S> {
    session: Session<'a>,
    save: S,
    shown: Option<Shown>,
    input: Input,
    last_tick: Instant,
    error: Option<DesktopError>,
}

/// A window and the memory its pixels go to.
struct Shown {
    window: Rc<Window>,
    surface: Surface<Rc<Window>, Rc<Window>>,
    title: String,
}

impl Shown {
    fn open(event_loop: &ActiveEventLoop, session: &Session<'_>) -> Result<Self, DesktopError> {
        let refused = |error: &dyn std::fmt::Display| DesktopError::Window(error.to_string());
        let (width, height) = session.size();
        let title = session.title();
        let attributes = Window::default_attributes()
            .with_title(title.as_str())
            .with_inner_size(LogicalSize::new(width as f64, height as f64));
        let window = Rc::new(event_loop.create_window(attributes).map_err(|e| refused(&e))?);
        let context = Context::new(window.clone()).map_err(|e| refused(&e))?;
        let surface = Surface::new(&context, window.clone()).map_err(|e| refused(&e))?;
        Ok(Self { window, surface, title })
    }

    /// Shows the picture.
    fn show(&mut self, session: &mut Session<'_>) -> Result<(), softbuffer::SoftBufferError> {
        let canvas = session.picture();
        let side = |n: usize| u32::try_from(n).ok().and_then(NonZeroU32::new).unwrap_or(NonZeroU32::MIN);
        self.surface.resize(side(canvas.width()), side(canvas.height()))?;
        let mut buffer = self.surface.buffer_mut()?;
        buffer.copy_from_slice(canvas.pixels());
        self.window.pre_present_notify();
        buffer.present()
    }
}

impl<S: FnMut(&Canvas)> Desktop<'_, S> {
    fn tell(&mut self, event: Event) {
        self.session.event(event);
    }

    /// Gives up.
    fn fail(&mut self, event_loop: &ActiveEventLoop, error: DesktopError) {
        self.error.get_or_insert(error);
        event_loop.exit();
    }

    /// A key goes down or up.
    fn key(&mut self, event: &KeyEvent) {
        let saves = self.input.modifiers.control_key()
            && matches!(&event.logical_key, WindowKey::Character(c) if c.eq_ignore_ascii_case("s"));
        if saves && event.state.is_pressed() {
            if !event.repeat {
                (self.save)(self.session.picture());
            }
        } else if let Some(event) = self.input.key(event) {
            self.tell(event);
        }
    }

    /// The window has another size, or another density.
    fn resize(&mut self, PhysicalSize { width, height }: PhysicalSize<u32>) {
        // A window without pixels is one that is not seen.
        if width > 0 && height > 0 {
            self.tell(Event::Resize(width as usize, height as usize));
        }
    }

    /// Lets the time go on for an animated program, and says when the next tick is.
    fn tick(&mut self, event_loop: &ActiveEventLoop) {
        if !self.session.is_animated() {
            self.last_tick = Instant::now();
            event_loop.set_control_flow(ControlFlow::Wait);
            return;
        }
        let now = Instant::now();
        let gone = now - self.last_tick;
        if gone >= FRAME {
            self.last_tick = now;
            self.tell(Event::Tick(gone.as_secs_f64().min(LONGEST_TICK)));
        }
        event_loop.set_control_flow(ControlFlow::WaitUntil(self.last_tick + FRAME));
    }

    /// Brings the window up to date with the program.
    fn update(&mut self, event_loop: &ActiveEventLoop) {
        if self.session.has_ended() {
            return event_loop.exit();
        }
        let Some(shown) = &mut self.shown else { return };
        let title = self.session.title();
        if shown.title != title {
            shown.window.set_title(&title);
            shown.title = title;
        }
        if self.session.is_stale() {
            shown.window.request_redraw();
        }
    }
}

impl<S: FnMut(&Canvas)> ApplicationHandler for Desktop<'_, S> {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        if self.shown.is_some() {
            return;
        }
        match Shown::open(event_loop, &self.session) {
            Ok(shown) => {
                self.resize(shown.window.inner_size());
                shown.window.request_redraw();
                self.shown = Some(shown);
                self.last_tick = Instant::now();
            }
            Err(error) => self.fail(event_loop, error),
        }
    }

    fn new_events(&mut self, event_loop: &ActiveEventLoop, cause: StartCause) {
        // Time goes on while the user is busy, too.
        if cause != StartCause::Init {
            self.tick(event_loop);
        }
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        match event {
            WindowEvent::CloseRequested => return event_loop.exit(),
            WindowEvent::RedrawRequested => {
                let shown = self.shown.as_mut().map_or(Ok(()), |shown| shown.show(&mut self.session));
                if let Err(error) = shown {
                    return self.fail(event_loop, DesktopError::Picture(error.to_string()));
                }
            }
            WindowEvent::Resized(size) => {
                self.resize(size);
                if let Some(shown) = &self.shown {
                    shown.window.request_redraw();
                }
            }
            WindowEvent::KeyboardInput { event, is_synthetic: false, .. } => self.key(&event),
            other => {
                for event in self.input.events(&other) {
                    self.tell(event);
                }
            }
        }
        self.update(event_loop);
    }

    fn about_to_wait(&mut self, event_loop: &ActiveEventLoop) {
        self.tick(event_loop);
        self.update(event_loop);
    }
}

/// What the user holds down, and where the mouse is.
#[derive(Default)]
struct Input {
    mouse: [i32; 2],
    modifiers: ModifiersState,
    /// Keys that are down, as they were told: with Shift let go first, `A` would come up as `a`.
    keys: HashMap<PhysicalKey, Key>,
    buttons: HashSet<Button>,
}

impl Input {
    /// What a key means for a program, if anything.
    fn key(&mut self, event: &KeyEvent) -> Option<Event> {
        match event.state {
            ElementState::Pressed => {
                let key = key_of(&event.logical_key)?;
                self.keys.insert(event.physical_key, key);
                Some(Event::KeyDown(key))
            }
            ElementState::Released => self.keys.remove(&event.physical_key).map(Event::KeyUp),
        }
    }

    /// What an event of the window other than keys means for a program.
    fn events(&mut self, event: &WindowEvent) -> Vec<Event> {
        let [x, y] = self.mouse;
        match event {
            WindowEvent::ModifiersChanged(modifiers) => self.modifiers = modifiers.state(),
            WindowEvent::CursorMoved { position, .. } => {
                let to = [position.x.floor() as i32, position.y.floor() as i32];
                if to != self.mouse {
                    self.mouse = to;
                    return vec![Event::Move(to[0], to[1])];
                }
            }
            WindowEvent::MouseInput { state, button, .. } => {
                let Some(button) = button_of(*button) else { return Vec::new() };
                return match state {
                    ElementState::Pressed => {
                        self.buttons.insert(button);
                        vec![Event::Press(button, x, y)]
                    }
                    ElementState::Released if self.buttons.remove(&button) => {
                        vec![Event::Release(button, x, y)]
                    }
                    ElementState::Released => Vec::new(),
                };
            }
            WindowEvent::MouseWheel { delta, .. } => {
                let notches = match delta {
                    MouseScrollDelta::LineDelta(_, y) => *y,
                    MouseScrollDelta::PixelDelta(by) => (by.y / PIXELS_PER_NOTCH) as f32,
                };
                return if notches == 0.0 { Vec::new() } else { vec![Event::Wheel(notches)] };
            }
            // What comes up elsewhere is not told here.
            WindowEvent::Focused(false) => return self.let_go(),
            _ => {}
        }
        Vec::new()
    }

    /// Everything that is down comes up.
    fn let_go(&mut self) -> Vec<Event> {
        let [x, y] = self.mouse;
        let keys = self.keys.drain().map(|(_, key)| Event::KeyUp(key));
        let buttons = self.buttons.drain().map(|button| Event::Release(button, x, y));
        self.modifiers = ModifiersState::empty();
        keys.chain(buttons).collect()
    }
}

fn button_of(button: MouseButton) -> Option<Button> {
    match button {
        MouseButton::Left => Some(Button::Left),
        MouseButton::Middle => Some(Button::Middle),
        MouseButton::Right => Some(Button::Right),
        _ => None,
    }
}

fn key_of(key: &WindowKey) -> Option<Key> {
    let named = match key {
        WindowKey::Character(text) => {
            let mut characters = text.chars();
            return characters
                .next()
                .filter(|c| !c.is_control() && characters.next().is_none())
                .map(Key::Char);
        }
        WindowKey::Named(named) => named,
        _ => return None,
    };
    Some(match named {
        NamedKey::Space => Key::Char(' '),
        NamedKey::ArrowLeft => Key::Left,
        NamedKey::ArrowRight => Key::Right,
        NamedKey::ArrowUp => Key::Up,
        NamedKey::ArrowDown => Key::Down,
        NamedKey::PageUp => Key::PageUp,
        NamedKey::PageDown => Key::PageDown,
        NamedKey::Home => Key::Home,
        NamedKey::End => Key::End,
        NamedKey::Enter => Key::Enter,
        NamedKey::Escape => Key::Escape,
        NamedKey::Backspace => Key::Backspace,
        NamedKey::Delete => Key::Delete,
        NamedKey::Tab => Key::Tab,
        named => return function_key(*named),
    })
}

fn function_key(named: NamedKey) -> Option<Key> {
    use NamedKey::{F1, F2, F3, F4, F5, F6, F7, F8, F9, F10, F11, F12};
    let all = [F1, F2, F3, F4, F5, F6, F7, F8, F9, F10, F11, F12];
    all.iter().zip(1..).find(|(key, _)| **key == named).map(|(_, number)| Key::Function(number))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_of_the_window_are_keys_of_programs() {
        assert_eq!(key_of(&WindowKey::Character("a".into())), Some(Key::Char('a')));
        assert_eq!(key_of(&WindowKey::Character("\u{13}".into())), None);
        assert_eq!(key_of(&WindowKey::Character("ab".into())), None);
        assert_eq!(key_of(&WindowKey::Named(NamedKey::Space)), Some(Key::Char(' ')));
        assert_eq!(key_of(&WindowKey::Named(NamedKey::F12)), Some(Key::Function(12)));
        assert_eq!(key_of(&WindowKey::Named(NamedKey::Shift)), None);
    }

    #[test]
    fn what_is_held_is_let_go_with_the_focus() {
        let mut input = Input { mouse: [3, 4], ..Input::default() };
        input.keys.insert(PhysicalKey::Code(winit::keyboard::KeyCode::KeyA), Key::Char('A'));
        input.buttons.insert(Button::Right);
        let events = input.events(&WindowEvent::Focused(false));
        assert_eq!(events, [Event::KeyUp(Key::Char('A')), Event::Release(Button::Right, 3, 4)]);
        assert_eq!(input.events(&WindowEvent::Focused(false)), []);
    }
}
