//! The one loop over waves.

use super::{Plan, Step};
use crate::error::Result;

/// What runs the steps of a plan for one launch.
pub trait Executor {
    /// Runs a step over the slots of the wave, or hands it to a device that will.
    ///
    /// # Errors
    /// What the device reports.
    fn step(&mut self, index: usize, step: &Step) -> Result<()>;

    /// Whether another wave is to run: some ray may be left.
    ///
    /// # Errors
    /// What the device reports.
    fn goes_on(&mut self) -> Result<bool>;
}

/// Runs a launch: the wave of the camera's rays, further waves while rays are left, and what ends it. Steps are counted as
/// [`Plan::steps`] lists them.
///
/// # Errors
/// Those of the executor.
pub fn run(plan: &Plan, executor: &mut impl Executor) -> Result<()> {
    let all = |from: usize, steps: &[Step], executor: &mut _| -> Result<()> {
        steps.iter().zip(from..).try_for_each(|(step, index)| Executor::step(executor, index, step))
    };
    all(0, &plan.first, executor)?;
    let further = plan.first.len();
    while !plan.further.is_empty() && executor.goes_on()? {
        all(further, &plan.further, executor)?;
    }
    all(further + plan.further.len(), &plan.last, executor)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrator::{Needs, WHITTED, Waves};
    use crate::method::{Method, Traversal};
    use crate::plan::Stage;

    struct Log(Vec<(usize, Stage)>, u32);

    impl Executor for Log {
        fn step(&mut self, index: usize, step: &Step) -> Result<()> {
            self.0.push((index, step.stage));
            Ok(())
        }
        fn goes_on(&mut self) -> Result<bool> {
            self.1 -= 1;
            Ok(self.1 > 0)
        }
    }

    #[test]
    fn further_waves_run_while_rays_are_left_and_the_film_is_last() {
        let needs = Needs { shadow_rays: 0, paths: 1, waves: Waves::AtMost(9), stages: &WHITTED };
        let plan = Plan::of(&needs, Default::default(), 0, |_| Ok(Traversal::from(Method::IfIf))).unwrap();
        let mut log = Log(Vec::new(), 3);
        run(&plan, &mut log).unwrap();
        let wave = [(2, Stage::Advance), (3, Stage::Trace), (4, Stage::Shade)];
        assert_eq!(log.0[..2], [(0, Stage::Trace), (1, Stage::Shade)]);
        assert_eq!(log.0[2..8], [wave, wave].concat());
        assert_eq!(log.0[8..], [(5, Stage::Gather)]);
    }
}
