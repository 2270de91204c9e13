//! Loops compiled a second time for the wide vector units of the machine, chosen at run time.

/// Defines a function whose body, and everything `#[inline(always)]` that it calls, is compiled for the widest vector unit
/// that the machine at hand has. Every borrowed argument carries the one lifetime that is named.
macro_rules! vectorised {
    ($(#[$meta:meta])* $vis:vis fn $name:ident<$life:lifetime>($($arg:ident: $type:ty),* $(,)?) -> $out:ty $body:block) => {
        $(#[$meta])*
        #[allow(clippy::too_many_arguments)]
        $vis fn $name<$life>($($arg: $type),*) -> $out {
            struct Job<$life> {
                $($arg: $type,)*
                marker: std::marker::PhantomData<&$life ()>,
            }
            impl<$life> pulp::NullaryFnOnce for Job<$life> {
                type Output = $out;
                #[inline(always)]
                fn call(self) -> $out {
                    let Self { $($arg,)* marker: _ } = self;
                    $body
                }
            }
            pulp::Arch::new().dispatch(Job { $($arg,)* marker: std::marker::PhantomData })
        }
    };
}
pub(crate) use vectorised;
