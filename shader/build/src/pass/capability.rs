//! Capabilities: only what a module uses, since a device is asked for each.

use std::collections::HashSet;

use rspirv::dr::Module;
use rspirv::spirv::Capability;

use crate::compile::FLOATS_AS_WRITTEN;

const SUBGROUP: [Capability; 7] = [
    Capability::GroupNonUniformVote,
    Capability::GroupNonUniformBallot,
    Capability::GroupNonUniformArithmetic,
    Capability::GroupNonUniformShuffle,
    Capability::GroupNonUniformShuffleRelative,
    Capability::GroupNonUniformClustered,
    Capability::GroupNonUniformQuad,
];

/// Removes the capability that only guards the compilation, and those of subgroup operations that
/// no instruction and no built-in variable needs.
pub fn prune(module: &mut Module) {
    let mut needed = needed(module);
    if SUBGROUP.iter().any(|capability| needed.contains(capability)) {
        needed.insert(Capability::GroupNonUniform);
    }
    module.capabilities.retain(|inst| {
        let capability = inst.operands[0].unwrap_capability();
        let is_subgroup = capability == Capability::GroupNonUniform || SUBGROUP.contains(&capability);
        capability != FLOATS_AS_WRITTEN && (!is_subgroup || needed.contains(&capability))
    });
}

fn needed(module: &Module) -> HashSet<Capability> {
    let bodies = module.functions.iter().flat_map(|f| f.all_inst_iter());
    let mut needed = HashSet::new();
    for inst in bodies.chain(&module.annotations) {
        needed.extend(inst.class.capabilities);
        needed.extend(inst.operands.iter().flat_map(|o| o.required_capabilities()));
    }
    needed
}
