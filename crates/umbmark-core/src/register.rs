//! Files that each hold one thing of a kind, listed by a word each.

/// Makes the `mod` lines of files that each hold one thing of a kind, and the list of these things in the order of the files.
///
/// ```text
/// register! {
///     /// Every shape there is.
///     pub SHAPES: Shape = SHAPE in square, circle
/// }
/// // mod square; mod circle; pub static SHAPES: &[&Shape] = &[&square::SHAPE, &circle::SHAPE];
/// ```
#[macro_export]
macro_rules! register {
    ($(#[$about:meta])* $vis:vis $LIST:ident: $Kind:ty = $ITEM:ident in $($file:ident),+ $(,)?) => {
        $(mod $file;)+

        $(#[$about])*
        $vis static $LIST: &[&$Kind] = &[$(&$file::$ITEM,)+];
    };
}
