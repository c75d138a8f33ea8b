//! Hierarchical radiosity with clusters: light is exchanged between whole polygons, parts of them, and
//! groups of them, whatever is good enough.
//!
//! 1. Polygons are grouped into clusters, clusters into larger ones ([`cluster`]).
//! 2. A link says that light goes from one node to another: an element, a cluster, a lamp. The first
//!    link joins the cluster of everything with itself.
//! 3. An oracle looks at each link: if it may be wrong by more than a threshold of power, one of its
//!    ends is divided, and links of the parts take its place ([`oracle`], [`refine`]).
//! 4. Light is gathered along the links at every node, pushed down to the leaves, where it is turned
//!    into radiosity, and pulled up as means weighted by area, until little changes ([`exchange`]). What
//!    bounces would take long for is found from the last of them ([`mixing`]).
//! 5. Then the threshold is lowered, and the links are looked at again with what is known of the light
//!    by then: links of dark sources stay coarse (multigridding).
//!
//! Sources: Hanrahan, Salzman and Aupperle 1991, "A rapid hierarchical radiosity algorithm"; Smits,
//! Arvo and Greenberg 1994, "A clustering algorithm for radiosity in complex environments"; Sillion
//! 1995, "A unified hierarchical algorithm for global illumination with scattering volumes and object
//! clusters".

pub(crate) mod cluster;
mod exchange;
pub(crate) mod facet;
mod link;
mod lost;
mod mixing;
mod moments;
pub(crate) mod node;
mod oracle;
mod refine;
mod settings;
mod sight;
mod solver;
mod state;
#[cfg(test)]
mod tests;

pub use settings::HierarchySettings;
pub use solver::solve_hierarchy;
