//! Option structs: they start with the library's defaults, and their fields are those of the header.

use packcell_sys as sys;

/// A struct of options that derefs to the header's. Only this crate says its size, so that the
/// library never looks past its end.
macro_rules! options {
    ($(#[$doc:meta])* $name:ident, $raw:ident, $init:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct $name(packcell_sys::$raw);

        impl $name {
            pub(crate) fn raw(&self) -> packcell_sys::$raw {
                let struct_size = std::mem::size_of::<packcell_sys::$raw>() as u32;
                packcell_sys::$raw { struct_size, ..self.0 }
            }
        }

        impl Default for $name {
            /// The library's defaults.
            fn default() -> Self {
                let raw = crate::handle::fresh(packcell_sys::$init);
                $name(raw.expect("the library knows the layout that it was built with"))
            }
        }

        impl std::ops::Deref for $name {
            type Target = packcell_sys::$raw;
            fn deref(&self) -> &Self::Target {
                &self.0
            }
        }

        impl std::ops::DerefMut for $name {
            fn deref_mut(&mut self) -> &mut Self::Target {
                &mut self.0
            }
        }
    };
}
pub(crate) use options;

options! {
    /// How much a plan may cost. In nodes alone it gives the same plan on every machine. The default
    /// is 200000 nodes.
    Budget, pkc_budget, pkc_budget_init
}

impl Budget {
    /// So many placements tried, however long they take; 0 is no limit.
    pub fn nodes(nodes: u64) -> Budget {
        Budget(sys::pkc_budget {
            nodes,
            milliseconds: 0.0,
            ..Budget::default().0
        })
    }

    /// So much wall time.
    pub fn milliseconds(milliseconds: f64) -> Budget {
        Budget(sys::pkc_budget {
            nodes: 0,
            milliseconds,
            ..Budget::default().0
        })
    }
}
