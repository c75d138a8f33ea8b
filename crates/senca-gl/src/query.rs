//! Occlusion queries (OpenGL 1.5, section 4.1.7).

use crate::{Context, Enum, gl};
use std::collections::HashMap;

/// A query's state.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Query {
    made: bool,
    samples: u64,
}

/// All queries of a context.
#[derive(Debug, Default)]
pub(crate) struct Occlusion {
    queries: HashMap<u32, Query>,
    /// Name of the query that counts.
    current: Option<u32>,
}

impl Occlusion {
    pub(crate) fn active(&self) -> bool {
        self.current.is_some()
    }

    /// Adds samples that have passed.
    pub(crate) fn add(&mut self, samples: u64) {
        if let Some(query) = self.current.and_then(|name| self.queries.get_mut(&name)) {
            query.samples += samples;
        }
    }
}

impl Context {
    /// `glGenQueries`: unused names.
    pub fn gen_queries(&mut self, n: i32) -> Vec<u32> {
        self.ask(|c| {
            if !(0..=crate::arrays::MAX_NAMES).contains(&n) {
                c.error(gl::INVALID_VALUE);
                return Vec::new();
            }
            let queries = &mut c.queries.queries;
            let names = crate::arrays::free_names(n as usize, |name| queries.contains_key(&name));
            queries.extend(names.iter().map(|name| (*name, Query::default())));
            names
        })
    }

    /// `glDeleteQueries`. A query that counts stops.
    pub fn delete_queries(&mut self, names: &[u32]) {
        self.outside(|c| {
            c.flush_batch();
            for name in names {
                c.queries.queries.remove(name);
                if c.queries.current == Some(*name) {
                    c.queries.current = None;
                }
            }
            c.touch_raster();
        });
    }

    /// `glIsQuery`.
    pub fn is_query(&mut self, name: u32) -> bool {
        self.ask(|c| c.queries.queries.get(&name).is_some_and(|q| q.made))
    }

    /// `glBeginQuery`: counts samples that pass, target `SAMPLES_PASSED`.
    pub fn begin_query(&mut self, target: Enum, name: u32) {
        self.submit(move |c| {
            if target != gl::SAMPLES_PASSED {
                return c.error(gl::INVALID_ENUM);
            }
            if name == 0 || c.queries.active() {
                return c.error(gl::INVALID_OPERATION);
            }
            c.flush_batch();
            c.queries.queries.insert(name, Query { made: true, samples: 0 });
            c.queries.current = Some(name);
            c.touch_raster();
        });
    }

    /// `glEndQuery`.
    pub fn end_query(&mut self, target: Enum) {
        self.submit(move |c| {
            if target != gl::SAMPLES_PASSED {
                return c.error(gl::INVALID_ENUM);
            }
            c.flush_batch();
            if c.queries.current.take().is_none() {
                c.error(gl::INVALID_OPERATION);
            }
            c.touch_raster();
        });
    }

    /// `glGetQuery`: `CURRENT_QUERY` or `QUERY_COUNTER_BITS` of target `SAMPLES_PASSED`.
    pub fn get_query(&mut self, target: Enum, name: Enum) -> i32 {
        self.ask(|c| match (target, name) {
            (gl::SAMPLES_PASSED, gl::CURRENT_QUERY) => c.queries.current.map_or(0, |n| n as i32),
            (gl::SAMPLES_PASSED, gl::QUERY_COUNTER_BITS) => 32,
            _ => {
                c.error(gl::INVALID_ENUM);
                0
            }
        })
    }

    /// `glGetQueryObject`: `QUERY_RESULT` or `QUERY_RESULT_AVAILABLE`, which it always is.
    pub fn get_query_object(&mut self, query: u32, name: Enum) -> u32 {
        self.ask(|c| {
            let found = c.queries.queries.get(&query).filter(|q| q.made).copied();
            match (found, name) {
                (Some(_), _) if c.queries.current == Some(query) => c.error(gl::INVALID_OPERATION),
                (Some(q), gl::QUERY_RESULT) => return u32::try_from(q.samples).unwrap_or(u32::MAX),
                (Some(_), gl::QUERY_RESULT_AVAILABLE) => return 1,
                (Some(_), _) => c.error(gl::INVALID_ENUM),
                (None, _) => c.error(gl::INVALID_OPERATION),
            }
            0
        })
    }
}
