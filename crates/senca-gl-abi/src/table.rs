//! What the tables of commands are written with.

use std::ffi::c_void;

/// A function of the library that programs can ask for by name.
#[derive(Debug)]
pub struct Entry {
    /// As C calls it.
    pub name: &'static str,
    /// Where it is.
    pub address: *const c_void,
    /// Types of parameters and result, as in the table.
    #[cfg(test)]
    pub(crate) signature: &'static str,
}

impl Entry {
    /// A function of another library that depends on this crate.
    #[must_use]
    pub const fn new(name: &'static str, address: *const c_void) -> Self {
        Self {
            name,
            address,
            #[cfg(test)]
            signature: "",
        }
    }
}

// SAFETY: the address is that of a function, which all threads may call; nothing is written through it.
unsafe impl Sync for Entry {}

/// An answer of a command, and what it is when there is no context to ask.
pub trait Answer {
    /// Without a context.
    const NONE: Self;
}

macro_rules! answers {
    ($($t:ty: $none:expr),*) => {$( impl Answer for $t { const NONE: Self = $none; } )*};
}
answers!((): (), u8: 0, i32: 0, u32: 0, *const u8: std::ptr::null(), *mut c_void: std::ptr::null_mut());

/// Defines a C function that works on the current context.
macro_rules! define {
    ($c:ident $name:ident ($($arg:ident: $t:ty),* $(,)?) ($($r:ty)?) $body:expr) => {
        #[unsafe(no_mangle)]
        unsafe extern "C" fn $name($($arg: $t),*) $(-> $r)? {
            $crate::current::with(|$c| $body)
        }

        #[cfg(test)]
        mod $name {
            pub(super) const SIGNATURE: &str = concat!($(stringify!($t), ";",)* "->", $(stringify!($r))?);
        }
    };
}

/// The table of entries of functions defined before.
macro_rules! entries {
    ($table:ident: $($name:ident)*) => {
        pub(crate) static $table: &[$crate::table::Entry] = &[$(
            $crate::table::Entry {
                name: stringify!($name),
                address: $name as *const std::ffi::c_void,
                #[cfg(test)]
                signature: $name::SIGNATURE,
            },
        )*];
    };
}

/// Commands as C has them: names of the same command, parameters, and what it does with the current context.
macro_rules! commands {
    ($table:ident, $c:ident: $(
        $name:ident $(| $also:ident)* ($($arg:ident: $t:ty),* $(,)?) $(-> $r:ty)? $body:block
    )*) => {
        $( commands!(@names $c [$name $($also)*] ($($arg: $t),*) ($($r)?) $body); )*
        entries!($table: $($name $($also)*)*);
    };
    (@names $c:ident [$($name:ident)+] $params:tt $result:tt $body:block) => {
        $( define!($c $name $params $result $body); )+
    };
}

/// Commands that take numbers of several types, one by one and from memory: the method of the context, names
/// of the numbers, how many; then type by type the names of both forms. What is in `[]` comes first in both.
macro_rules! components {
    ($table:ident: $(
        $method:ident $([$first:ident])? ($($arg:ident)+) x $n:literal {
            $( $t:ty: $scalar:ident $(| $scalars:ident)*, $vector:ident $(| $vectors:ident)*; )+
        }
    )+) => {
        $( components!(@rows $method [$($first)?] ($($arg)+) $n $(
            {$t: [$scalar $($scalars)*] [$vector $($vectors)*]}
        )+); )+
        entries!($table: $($( $scalar $($scalars)* $vector $($vectors)* )+)+);
    };
    (@rows $method:ident $first:tt $args:tt $n:literal $($row:tt)+) => {
        $( components!(@row $method $first $args $n $row); )+
    };
    (@row $method:ident $first:tt $args:tt $n:literal {$t:ty: [$($scalar:ident)+] [$($vector:ident)+]}) => {
        $( components!(@scalar $method $first $args $t, $scalar); )+
        $( components!(@vector $method $first $n $t, $vector); )+
    };
    (@scalar $method:ident [$($first:ident)?] ($($arg:ident)+) $t:ty, $name:ident) => {
        define!(c $name ($($first: u32,)? $($arg: $t),+) () c.$method($($first,)? [$($arg),+]));
    };
    (@vector $method:ident [$($first:ident)?] $n:literal $t:ty, $name:ident) => {
        define!(c $name ($($first: u32,)? v: In<$t>) () if let Some(v) = v.array::<$n>() {
            c.$method($($first,)? v)
        });
    };
}
