//! Messages for whoever debugs a program (KHR_debug): the group stack, labels, the log and its callback.

use crate::state::Cap;
use crate::{Context, Enum, gl};
use std::collections::{HashMap, VecDeque};
use std::sync::Arc;

/// Messages the log holds; later ones are lost while it is full.
pub(crate) const MAX_LOGGED: usize = 64;
/// Longest message, its closing zero included.
pub(crate) const MAX_MESSAGE: usize = 4096;
/// Longest label, its closing zero included.
pub(crate) const MAX_LABEL: usize = 256;
/// Groups that may be open, the outermost included.
pub(crate) const MAX_GROUPS: usize = 64;

/// One message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DebugMessage {
    /// `DEBUG_SOURCE_API` and so on.
    pub source: Enum,
    /// `DEBUG_TYPE_ERROR` and so on.
    pub kind: Enum,
    /// Number of the message within source and type.
    pub id: u32,
    /// `DEBUG_SEVERITY_HIGH` and so on.
    pub severity: Enum,
    /// The text.
    pub text: String,
}

/// What is called with each message.
pub type DebugCallback = Arc<dyn Fn(&DebugMessage) + Send + Sync>;

/// A rule of `debug_message_control`; the last that fits counts.
#[derive(Clone, Debug)]
struct Rule {
    source: Enum,
    kind: Enum,
    severity: Enum,
    ids: Vec<u32>,
    on: bool,
}

impl Rule {
    fn fits(&self, m: &DebugMessage) -> bool {
        let one = |rule: Enum, of: Enum| rule == gl::DONT_CARE || rule == of;
        one(self.source, m.source)
            && one(self.kind, m.kind)
            && if self.ids.is_empty() { one(self.severity, m.severity) } else { self.ids.contains(&m.id) }
    }
}

/// State of KHR_debug.
#[derive(Default)]
pub(crate) struct Debug {
    callback: Option<DebugCallback>,
    log: VecDeque<DebugMessage>,
    rules: Vec<Rule>,
    groups: Vec<(DebugMessage, usize)>,
    labels: HashMap<(Enum, u32), String>,
}

impl std::fmt::Debug for Debug {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Debug").field("log", &self.log).field("groups", &self.groups.len()).finish()
    }
}

impl Debug {
    /// An error of the program.
    fn note_error(&mut self, code: Enum) {
        let text = match code {
            gl::INVALID_ENUM => "GL_INVALID_ENUM: a name that this command does not take",
            gl::INVALID_VALUE => "GL_INVALID_VALUE: a number out of range",
            gl::INVALID_OPERATION => "GL_INVALID_OPERATION: not allowed in the present state",
            gl::STACK_OVERFLOW => "GL_STACK_OVERFLOW: the stack is full",
            gl::STACK_UNDERFLOW => "GL_STACK_UNDERFLOW: the stack is empty",
            gl::OUT_OF_MEMORY => "GL_OUT_OF_MEMORY",
            _ => "GL_INVALID_FRAMEBUFFER_OPERATION: the framebuffer is not complete",
        };
        self.message(DebugMessage {
            source: gl::DEBUG_SOURCE_API,
            kind: gl::DEBUG_TYPE_ERROR,
            id: code,
            severity: gl::DEBUG_SEVERITY_HIGH,
            text: text.to_owned(),
        });
    }

    fn message(&mut self, message: DebugMessage) {
        let rule = self.rules.iter().rev().find(|r| r.fits(&message));
        // Messages of low severity are off unless asked for.
        let wanted = rule.map_or(message.severity != gl::DEBUG_SEVERITY_LOW, |r| r.on);
        if !wanted {
            return;
        }
        match &self.callback {
            Some(callback) => callback(&message),
            None if self.log.len() < MAX_LOGGED => self.log.push_back(message),
            None => {}
        }
    }

    pub(crate) fn logged(&self) -> usize {
        self.log.len()
    }

    pub(crate) fn next_length(&self) -> usize {
        self.log.front().map_or(0, |m| m.text.len() + 1)
    }

    pub(crate) fn group_depth(&self) -> usize {
        self.groups.len() + 1
    }
}

fn is_source(source: Enum, application_only: bool) -> bool {
    match source {
        gl::DEBUG_SOURCE_APPLICATION | gl::DEBUG_SOURCE_THIRD_PARTY => true,
        _ => !application_only && (gl::DEBUG_SOURCE_API..=gl::DEBUG_SOURCE_OTHER).contains(&source),
    }
}

fn is_type(kind: Enum) -> bool {
    (gl::DEBUG_TYPE_ERROR..=gl::DEBUG_TYPE_OTHER).contains(&kind)
        || (gl::DEBUG_TYPE_MARKER..=gl::DEBUG_TYPE_POP_GROUP).contains(&kind)
}

fn is_severity(severity: Enum) -> bool {
    (gl::DEBUG_SEVERITY_HIGH..=gl::DEBUG_SEVERITY_LOW).contains(&severity)
        || severity == gl::DEBUG_SEVERITY_NOTIFICATION
}

impl Context {
    /// Tells of an error where messages are wanted.
    pub(crate) fn note_error(&mut self, code: Enum) {
        if self.debugs() {
            self.debug.note_error(code);
        }
    }

    fn debugs(&self) -> bool {
        self.state.enabled.has(Cap::DebugOutput)
    }

    /// A message, where messages are wanted.
    fn message(&mut self, message: DebugMessage) {
        if self.debugs() {
            self.debug.message(message);
        }
    }

    /// `glDebugMessageCallback`: what is called with each message from now on, instead of the log.
    pub fn debug_message_callback(&mut self, callback: Option<DebugCallback>) {
        self.debug.callback = callback;
    }

    /// `glDebugMessageControl`.
    pub fn debug_message_control(&mut self, source: Enum, kind: Enum, severity: Enum, ids: &[u32], on: bool) {
        let any = gl::DONT_CARE;
        let valid = (source == any || is_source(source, false))
            && (kind == any || is_type(kind))
            && (severity == any || is_severity(severity));
        if !valid {
            return self.error(gl::INVALID_ENUM);
        }
        if !ids.is_empty() && (source == any || kind == any || severity != any) {
            return self.error(gl::INVALID_OPERATION);
        }
        if source == any && kind == any && severity == any {
            self.debug.rules.truncate(self.debug.groups.last().map_or(0, |g| g.1));
        }
        self.debug.rules.push(Rule { source, kind, severity, ids: ids.to_vec(), on });
    }

    /// `glDebugMessageInsert`: a message of the program's own.
    pub fn debug_message_insert(&mut self, source: Enum, kind: Enum, id: u32, severity: Enum, text: &str) {
        if !is_source(source, true) || !is_type(kind) || !is_severity(severity) {
            return self.error(gl::INVALID_ENUM);
        }
        if text.len() >= MAX_MESSAGE {
            return self.error(gl::INVALID_VALUE);
        }
        self.message(DebugMessage { source, kind, id, severity, text: text.to_owned() });
    }

    /// `glGetDebugMessageLog`: takes the oldest message out of the log, if it and its closing zero fit `room` bytes.
    pub fn take_debug_message(&mut self, room: usize) -> Option<DebugMessage> {
        let fits = self.debug.log.front().is_some_and(|m| m.text.len() < room);
        if fits { self.debug.log.pop_front() } else { None }
    }

    /// `glPushDebugGroup`.
    pub fn push_debug_group(&mut self, source: Enum, id: u32, text: &str) {
        if !is_source(source, true) {
            return self.error(gl::INVALID_ENUM);
        }
        if text.len() >= MAX_MESSAGE {
            return self.error(gl::INVALID_VALUE);
        }
        if self.debug.group_depth() >= MAX_GROUPS {
            return self.error(gl::STACK_OVERFLOW);
        }
        let severity = gl::DEBUG_SEVERITY_NOTIFICATION;
        let kind = gl::DEBUG_TYPE_PUSH_GROUP;
        let message = DebugMessage { source, kind, id, severity, text: text.to_owned() };
        self.message(message.clone());
        self.debug.groups.push((message, self.debug.rules.len()));
    }

    /// `glPopDebugGroup`.
    pub fn pop_debug_group(&mut self) {
        let Some((mut message, rules)) = self.debug.groups.pop() else {
            return self.error(gl::STACK_UNDERFLOW);
        };
        self.debug.rules.truncate(rules);
        message.kind = gl::DEBUG_TYPE_POP_GROUP;
        self.debug.message(message);
    }

    /// Whether there is an object of a kind that can have a label.
    fn check_object(&mut self, kind: Enum, name: u32) -> Result<(), Enum> {
        let exists = match kind {
            gl::BUFFER => self.is_buffer(name),
            gl::DISPLAY_LIST => self.is_list(name),
            gl::FRAMEBUFFER => self.is_framebuffer(name),
            gl::QUERY => self.is_query(name),
            gl::RENDERBUFFER => self.is_renderbuffer(name),
            gl::TEXTURE => self.is_texture(name),
            // Of these there are none.
            gl::PROGRAM | gl::SAMPLER | gl::SHADER | gl::VERTEX_ARRAY => false,
            _ => return Err(gl::INVALID_ENUM),
        };
        if exists { Ok(()) } else { Err(gl::INVALID_VALUE) }
    }

    /// `glObjectLabel`: names an object of a kind; an empty label takes the name away.
    pub fn object_label(&mut self, kind: Enum, name: u32, label: &str) {
        if let Err(error) = self.check_object(kind, name) {
            return self.error(error);
        }
        if label.len() >= MAX_LABEL {
            return self.error(gl::INVALID_VALUE);
        }
        if label.is_empty() {
            self.debug.labels.remove(&(kind, name));
        } else if self.debug.labels.len() < 1 << 20 {
            self.debug.labels.insert((kind, name), label.to_owned());
        }
    }

    /// `glGetObjectLabel`; empty when it has none, `None` when there is no such object.
    pub fn get_object_label(&mut self, kind: Enum, name: u32) -> Option<&str> {
        if let Err(error) = self.check_object(kind, name) {
            self.error(error);
            return None;
        }
        Some(self.debug.labels.get(&(kind, name)).map_or("", String::as_str))
    }
}
