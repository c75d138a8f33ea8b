//! Interactive programs whose pictures the processor draws.
//!
//! A [`Program`] gets [`Event`]s and draws itself into a [`Canvas`]; whoever runs it decides where the events
//! come from and where the picture goes: [`Script`] replays a session from a text without a display, and
//! `desktop`, with the cargo feature of that name, opens a window.
//!
//! ```
//! use senca_window::{Canvas, Event, Flow, Key, Program, Script};
//!
//! /// Grey that space makes brighter.
//! struct Grey(u32);
//!
//! impl Program for Grey {
//!     fn title(&self) -> String {
//!         format!("Grey {}", self.0)
//!     }
//!     fn size(&self) -> (usize, usize) {
//!         (4, 3)
//!     }
//!     fn event(&mut self, event: Event) -> Flow {
//!         match event {
//!             Event::KeyDown(Key::Char(' ')) => self.0 += 1,
//!             _ => return Flow::Wait,
//!         }
//!         Flow::Redraw
//!     }
//!     fn draw(&mut self, canvas: &mut Canvas) {
//!         canvas.fill(0x01_01_01 * self.0);
//!     }
//! }
//!
//! let script = Script::parse("grey.script", "key space\nkey space  # once more\n")?;
//! let picture = script.run(&mut Grey(5), |_, _| Ok::<_, std::convert::Infallible>(()))?;
//! assert_eq!(picture.get(0, 0), Some(0x07_07_07));
//! # Ok::<_, Box<dyn std::error::Error>>(())
//! ```

mod canvas;
#[cfg(feature = "desktop")]
pub mod desktop;
mod event;
mod key_name;
mod script;
mod session;

pub use canvas::Canvas;
pub use event::{Button, Event, Flow, Key, Program};
pub use script::{Script, ScriptError, ScriptErrorKind};
pub use session::{MAX_PIXELS, MAX_SIDE, Session};
