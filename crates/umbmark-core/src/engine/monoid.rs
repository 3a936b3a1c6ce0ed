//! Elements with an ordered product.

/// A set in which the word of a segment can be multiplied: anything with an associative product and powers.
///
/// Rigid motions make it odometry; strings make it the word itself, which is how the combinatorics are tested.
///
/// ```
/// use umbmark_core::engine::{Letter, Monoid, WheelLine, word_product};
///
/// #[derive(Clone)]
/// struct Spelling(String);
/// impl Monoid for Spelling {
///     type Root = ();
///     fn identity() -> Self { Spelling(String::new()) }
///     fn then(&self, next: &Self) -> Self { Spelling(format!("{}{}", self.0, next.0)) }
///     fn root(&self) {}
///     fn power_from(&self, _: (), exponent: u64) -> Self { Spelling(self.0.repeat(exponent as usize)) }
/// }
///
/// let line = WheelLine::from_ticks([0.0, 0.5], [5.0, 3.0])?;
/// let word = word_product(&line, |letter| Spelling(format!("{letter:?}")[..1].into()));
/// assert_eq!(word.0, "RLLRLLRL");
/// # Ok::<(), umbmark_core::engine::EngineError>(())
/// ```
pub trait Monoid: Clone {
    /// What all powers of one element have in common, worked out once for several of them.
    type Root: Copy;

    /// The element that changes nothing.
    fn identity() -> Self;

    /// The product of this element and `next`, in this order.
    fn then(&self, next: &Self) -> Self;

    /// What the powers of this element share.
    fn root(&self) -> Self::Root;

    /// This element `exponent` times, given its own [`Monoid::root`]; the identity for 0.
    fn power_from(&self, root: Self::Root, exponent: u64) -> Self;

    /// This element `exponent` times; the identity for 0.
    #[inline]
    fn power(&self, exponent: u64) -> Self {
        self.power_from(self.root(), exponent)
    }
}
