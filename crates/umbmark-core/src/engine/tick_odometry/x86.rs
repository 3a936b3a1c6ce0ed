//! Which lanes an x86-64 machine has. The `unsafe` here is the crossing into code compiled for more than every machine.

use super::TickOdometry;
use super::lanes::{Block, RESULTS, Results, fits, results};
use crate::engine::lane::x86::{Avx2, Avx512, Register};
use crate::engine::{Instructions, Motion, WheelLine};

impl TickOdometry {
    pub(super) fn motions_in_lanes<L: AsRef<WheelLine>>(&self, lines: &[L], motions: &mut [Motion]) {
        if self.instructions == Instructions::Avx512 {
            // SAFETY: `instructions` is never more than what the machine was found to have.
            self.in_blocks::<8, L>(lines, motions, |block| unsafe { self.eight(block) });
        } else {
            // SAFETY: as above; there is no case below AVX2 here.
            self.in_blocks::<4, L>(lines, motions, |block| unsafe { self.four(block) });
        }
    }

    #[inline(always)]
    fn in_blocks<const N: usize, L: AsRef<WheelLine>>(
        &self,
        lines: &[L],
        motions: &mut [Motion],
        results: impl Fn(&Block<N>) -> Results<N>,
    ) {
        for (lines, motions) in lines.chunks(N).zip(motions.chunks_mut(N)) {
            let Results([x, y, heading, cosine, sine, ties]) = &results(&Block::new(lines));
            for (i, motion) in motions.iter_mut().enumerate().take(lines.len()) {
                // Number by number: a struct put together first is written and read again in different widths.
                (motion.pose.x, motion.pose.y, motion.pose.heading) = (x[i], y[i], heading[i]);
                (motion.cosine, motion.sine) = (cosine[i], sine[i]);
            }
            for (i, (line, motion)) in lines.iter().map(AsRef::as_ref).zip(motions).enumerate() {
                if ties[i] != 0.0 || !fits(line) {
                    *motion = self.motion(line);
                }
            }
        }
    }

    #[target_feature(enable = "avx512f,avx512dq")]
    fn eight(&self, block: &Block<8>) -> Results<8> {
        // SAFETY: this is compiled for these instructions only.
        unsafe { self.in_registers::<Avx512, 8>(block) }
    }

    #[target_feature(enable = "avx2")]
    fn four(&self, block: &Block<4>) -> Results<4> {
        // SAFETY: as above.
        unsafe { self.in_registers::<Avx2, 4>(block) }
    }

    /// # Safety
    /// The machine must have the register's instructions.
    #[inline(always)]
    unsafe fn in_registers<R: Register<N>, const N: usize>(&self, block: &Block<N>) -> Results<N> {
        // SAFETY: guaranteed by the caller.
        let [start, travel] =
            [&block.start, &block.travel].map(|wheels| unsafe { [R::load(&wheels[0]), R::load(&wheels[1])] });
        let results = results(&self.geometry, [&self.left, &self.right], start, travel);
        let mut values = Results([[0.0; N]; RESULTS]);
        for (result, values) in results.into_iter().zip(&mut values.0) {
            result.store(values);
        }
        values
    }
}
