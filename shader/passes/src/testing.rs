//! Small modules for the tests of the passes.

// Most functions add the instruction of their name.
#![allow(missing_docs, clippy::new_without_default)]

use rspirv::dr::{Builder, Module, Operand};
use rspirv::spirv::*;

/// A module under construction: an input and an output buffer of one float, and a counter.
pub struct Kernel {
    builder: Builder,
    ids: Ids,
    interface: Vec<Word>,
}

#[derive(Clone, Copy)]
struct Ids {
    void: Word,
    float: Word,
    uint: Word,
    signature: Word,
    input: Word,
    output: Word,
    counter: Word,
    glsl: Word,
}

impl Kernel {
    pub fn new() -> Self {
        let mut b = Builder::new();
        b.set_version(1, 5);
        b.capability(Capability::Shader);
        b.memory_model(AddressingModel::Logical, MemoryModel::Vulkan);
        let glsl = b.ext_inst_import("GLSL.std.450");
        let (void, float, uint) = (b.type_void(), b.type_float(32, None), b.type_int(32, 0));
        let signature = b.type_function(void, []);
        let mut variable = |kind| {
            let pointer = b.type_pointer(None, StorageClass::Private, kind);
            b.variable(pointer, None, StorageClass::Private, None)
        };
        let ids = Ids {
            void,
            float,
            uint,
            signature,
            input: variable(float),
            output: variable(float),
            counter: variable(uint),
            glsl,
        };
        let interface = vec![ids.input, ids.output, ids.counter];
        Kernel { builder: b, ids, interface }
    }

    pub fn file(&mut self, path: &str) -> Word {
        self.builder.string(path)
    }

    pub fn name(&mut self, id: Word, name: &str) {
        self.builder.name(id, name);
    }

    pub fn unused_id(&mut self) {
        self.builder.id();
    }

    /// A buffer at a binding, for the entry points that follow.
    pub fn buffer(&mut self, class: StorageClass, set: u32, binding: u32) -> Word {
        let b = &mut self.builder;
        let block = b.type_struct_id(None, [self.ids.float]);
        let pointer = b.type_pointer(None, class, block);
        let id = b.variable(pointer, None, class, None);
        for (decoration, value) in [(Decoration::DescriptorSet, set), (Decoration::Binding, binding)] {
            b.decorate(id, decoration, [Operand::LiteralBit32(value)]);
        }
        self.interface.push(id);
        id
    }

    pub fn decorate(&mut self, id: Word, decoration: Decoration) {
        self.builder.decorate(id, decoration, []);
    }

    /// A constant to specialise.
    pub fn spec_constant(&mut self, id: u32, default: u32) -> Word {
        let constant = self.builder.spec_constant_bit32(self.ids.uint, default);
        let operand = [Operand::LiteralBit32(id)];
        self.builder.decorate(constant, Decoration::SpecId, operand);
        constant
    }

    pub fn capability(&mut self, capability: Capability) {
        self.builder.capability(capability);
    }

    /// An entry point whose interface names every variable.
    pub fn entry(&mut self, name: &str, body: impl FnOnce(&mut Body)) {
        let function = self.function(FunctionControl::NONE, body);
        let model = ExecutionModel::GLCompute;
        self.builder.entry_point(model, function, name, self.interface.clone());
        self.builder.execution_mode(function, ExecutionMode::LocalSize, [32, 1, 1]);
    }

    /// A function that is never inlined.
    pub fn protected(&mut self, body: impl FnOnce(&mut Body)) -> Word {
        self.function(FunctionControl::DONT_INLINE, body)
    }

    fn function(&mut self, control: FunctionControl, body: impl FnOnce(&mut Body)) -> Word {
        let ids = self.ids;
        let b = &mut self.builder;
        let function = b.begin_function(ids.void, None, control, ids.signature).unwrap();
        b.begin_block(None).unwrap();
        body(&mut Body { b, ids });
        b.ret().unwrap();
        b.end_function().unwrap();
        function
    }

    pub fn module(self) -> Module {
        self.builder.module()
    }
}

/// The one block of a function.
pub struct Body<'a> {
    b: &'a mut Builder,
    ids: Ids,
}

impl Body<'_> {
    pub fn load_input(&mut self) -> Word {
        let Ids { float, input, .. } = self.ids;
        self.b.load(float, None, input, None, []).unwrap()
    }

    pub fn store_output(&mut self, value: Word) {
        self.b.store(self.ids.output, value, None, []).unwrap();
    }

    pub fn load_counter(&mut self, access: MemoryAccess) -> Word {
        let Ids { uint, counter, .. } = self.ids;
        self.b.load(uint, None, counter, Some(access), []).unwrap()
    }

    pub fn store_counter(&mut self, value: Word) {
        self.b.store(self.ids.counter, value, None, []).unwrap();
    }

    pub fn atomic_increment(&mut self, scope: Word, semantics: Word) {
        let Ids { uint, counter, .. } = self.ids;
        self.b.atomic_i_add(uint, None, counter, scope, semantics, scope).unwrap();
    }

    pub fn constant_u32(&mut self, value: u32) -> Word {
        self.b.constant_bit32(self.ids.uint, value)
    }

    pub fn constant_f32(&mut self, bits: u32) -> Word {
        self.b.constant_bit32(self.ids.float, bits)
    }

    pub fn float_type(&mut self, width: u32) {
        self.b.type_float(width, None);
    }

    pub fn i_add(&mut self, x: Word, y: Word) -> Word {
        self.b.i_add(self.ids.uint, None, x, y).unwrap()
    }

    pub fn f_negate(&mut self, x: Word) -> Word {
        self.b.f_negate(self.ids.float, None, x).unwrap()
    }

    pub fn f_add(&mut self, x: Word, y: Word) -> Word {
        self.b.f_add(self.ids.float, None, x, y).unwrap()
    }

    pub fn f_mul(&mut self, x: Word, y: Word) -> Word {
        self.b.f_mul(self.ids.float, None, x, y).unwrap()
    }

    pub fn f_div(&mut self, x: Word, y: Word) -> Word {
        self.b.f_div(self.ids.float, None, x, y).unwrap()
    }

    pub fn f_rem(&mut self, x: Word, y: Word) -> Word {
        self.b.f_rem(self.ids.float, None, x, y).unwrap()
    }

    pub fn glsl(&mut self, op: GlslStd450Op, x: Word) -> Word {
        let Ids { float, glsl, .. } = self.ids;
        self.b.ext_inst(float, None, glsl, op as u32, [Operand::IdRef(x)]).unwrap()
    }

    pub fn subgroup_sum(&mut self, x: Word) {
        let subgroup = self.constant_u32(Scope::Subgroup as u32);
        let operation = GroupOperation::Reduce;
        self.b.group_non_uniform_f_add(self.ids.float, None, subgroup, operation, x, None).unwrap();
    }

    /// Does `then` if a word has a bit.
    pub fn if_has(&mut self, word: Word, bit: u32, then: impl FnOnce(&mut Body)) {
        let has = self.has(word, bit);
        self.one_side(has, then);
    }

    /// One of two structs of two numbers, by whether a bit is set in a word.
    pub fn pair_if(
        &mut self,
        word: Word,
        bit: u32,
        then: impl FnOnce(&mut Body) -> Word,
        other: impl FnOnce(&mut Body) -> Word,
    ) -> Word {
        let kind = self.b.type_struct([self.ids.float; 2]);
        self.value_if(kind, (word, bit), then, other)
    }

    /// One of two numbers, likewise.
    pub fn number_if(
        &mut self,
        word: Word,
        bit: u32,
        then: impl FnOnce(&mut Body) -> Word,
        other: impl FnOnce(&mut Body) -> Word,
    ) -> Word {
        self.value_if(self.ids.float, (word, bit), then, other)
    }

    /// A number, or another one if a word has a bit; without a block for the other side.
    pub fn number_unless(&mut self, word: Word, bit: u32, x: Word, then: impl FnOnce(&mut Body) -> Word) -> Word {
        let (has, before) = (self.has(word, bit), self.b.id());
        self.b.branch(before).unwrap();
        self.b.begin_block(Some(before)).unwrap();
        let (other, inside) = self.one_side(has, then);
        self.b.phi(self.ids.float, None, [(other, inside), (x, before)]).unwrap()
    }

    fn has(&mut self, word: Word, bit: u32) -> Word {
        let (uint, bool) = (self.ids.uint, self.b.type_bool());
        let (bit, zero) = (self.constant_u32(bit), self.constant_u32(0));
        let masked = self.b.bitwise_and(uint, None, word, bit).unwrap();
        self.b.i_not_equal(bool, None, masked, zero).unwrap()
    }

    /// A selection of one side, whose value and block are returned.
    fn one_side<T>(&mut self, has: Word, then: impl FnOnce(&mut Body) -> T) -> (T, Word) {
        let (inside, after) = (self.b.id(), self.b.id());
        self.b.selection_merge(after, SelectionControl::NONE).unwrap();
        self.b.branch_conditional(has, inside, after, []).unwrap();
        let made = self.side(inside, after, then);
        self.b.begin_block(Some(after)).unwrap();
        (made, inside)
    }

    /// The block of a selection's side, which goes on to the end.
    fn side<T>(&mut self, block: Word, after: Word, fill: impl FnOnce(&mut Body) -> T) -> T {
        self.b.begin_block(Some(block)).unwrap();
        let made = fill(self);
        self.b.branch(after).unwrap();
        made
    }

    fn value_if(
        &mut self,
        kind: Word,
        (word, bit): (Word, u32),
        then: impl FnOnce(&mut Body) -> Word,
        other: impl FnOnce(&mut Body) -> Word,
    ) -> Word {
        let has = self.has(word, bit);
        let [inside, outside, after] = [0; 3].map(|_| self.b.id());
        self.b.selection_merge(after, SelectionControl::NONE).unwrap();
        self.b.branch_conditional(has, inside, outside, []).unwrap();
        let one = self.side(inside, after, then);
        let two = self.side(outside, after, other);
        self.b.begin_block(Some(after)).unwrap();
        self.b.phi(kind, None, [(one, inside), (two, outside)]).unwrap()
    }

    /// A loop that a word other than zero leaves in its first round, and whose way back has two blocks.
    pub fn leave_long_loop(&mut self, once: Word) {
        let (uint, bool) = (self.ids.uint, self.b.type_bool());
        let (zero, one) = (self.constant_u32(0), self.constant_u32(1));
        let [before, header, next, back, after] = [0; 5].map(|_| self.b.id());
        let (count, more) = (self.b.id(), self.b.id());
        self.b.branch(before).unwrap();
        self.b.begin_block(Some(before)).unwrap();
        self.b.branch(header).unwrap();
        self.b.begin_block(Some(header)).unwrap();
        self.b.phi(uint, Some(count), [(zero, before), (more, back)]).unwrap();
        let leaves = self.b.i_not_equal(bool, None, once, zero).unwrap();
        self.b.loop_merge(after, next, LoopControl::NONE, []).unwrap();
        self.b.branch_conditional(leaves, after, next, []).unwrap();
        self.b.begin_block(Some(next)).unwrap();
        self.b.i_add(uint, Some(more), count, one).unwrap();
        self.b.branch(back).unwrap();
        self.b.begin_block(Some(back)).unwrap();
        self.b.branch(header).unwrap();
        self.b.begin_block(Some(after)).unwrap();
        self.store_counter(count);
    }

    /// The sum of ones over as many rounds of a loop as a word says; another word leaves it after the first.
    pub fn count_up_to(&mut self, most: Word, once: Word) -> Word {
        let (uint, bool) = (self.ids.uint, self.b.type_bool());
        let (zero, one) = (self.constant_u32(0), self.constant_u32(1));
        let [before, header, body, next, after] = [0; 5].map(|_| self.b.id());
        let (count, more) = (self.b.id(), self.b.id());
        self.b.branch(before).unwrap();
        self.b.begin_block(Some(before)).unwrap();
        self.b.branch(header).unwrap();
        self.b.begin_block(Some(header)).unwrap();
        self.b.phi(uint, Some(count), [(zero, before), (more, next)]).unwrap();
        let goes_on = self.b.u_less_than(bool, None, count, most).unwrap();
        self.b.loop_merge(after, next, LoopControl::NONE, []).unwrap();
        self.b.branch_conditional(goes_on, body, after, []).unwrap();
        self.b.begin_block(Some(body)).unwrap();
        let leaves = self.b.i_not_equal(bool, None, once, zero).unwrap();
        self.b.branch_conditional(leaves, after, next, []).unwrap();
        self.b.begin_block(Some(next)).unwrap();
        self.b.i_add(uint, Some(more), count, one).unwrap();
        self.b.branch(header).unwrap();
        self.b.begin_block(Some(after)).unwrap();
        count
    }

    pub fn line(&mut self, file: Word) {
        self.b.line(file, 1, 2);
    }

    pub fn ballot_count(&mut self) {
        let uint = self.ids.uint;
        let ballot = self.b.type_vector(uint, 4);
        let mask = self.b.constant_null(ballot);
        let subgroup = self.constant_u32(Scope::Subgroup as u32);
        let operation = GroupOperation::Reduce;
        self.b.group_non_uniform_ballot_bit_count(uint, None, subgroup, operation, mask).unwrap();
    }

    pub fn call(&mut self, function: Word) {
        self.b.function_call(self.ids.void, None, function, []).unwrap();
    }

    /// A local variable that is stored to, and read and stored on if `read`.
    pub fn local(&mut self, value: Word, read: bool) {
        let float = self.ids.float;
        let pointer = self.b.type_pointer(None, StorageClass::Function, float);
        let variable = self.b.variable(pointer, None, StorageClass::Function, None);
        self.b.store(variable, value, None, []).unwrap();
        if read {
            let value = self.b.load(float, None, variable, None, []).unwrap();
            self.store_output(value);
        }
    }

    /// A struct of two numbers.
    pub fn pair(&mut self, x: Word, y: Word) -> Word {
        let kind = self.b.type_struct([self.ids.float; 2]);
        self.b.composite_construct(kind, None, [x, y]).unwrap()
    }

    /// A struct of a number and its double.
    pub fn pair_with_sum(&mut self, x: Word) -> Word {
        let sum = self.f_add(x, x);
        self.pair(sum, x)
    }

    /// A struct of two numbers with another in one of the places.
    pub fn pair_with(&mut self, pair: Word, place: u32, x: Word) -> Word {
        let kind = self.b.type_struct([self.ids.float; 2]);
        self.b.composite_insert(kind, None, x, pair, [place]).unwrap()
    }

    /// A vector of so many numbers of parts that are numbers or shorter vectors.
    pub fn vector(&mut self, numbers: u32, parts: &[Word]) -> Word {
        let kind = self.b.type_vector(self.ids.float, numbers);
        self.b.composite_construct(kind, None, parts.iter().copied()).unwrap()
    }

    /// A number of a struct or a vector.
    pub fn part(&mut self, composite: Word, place: u32) -> Word {
        self.b.composite_extract(self.ids.float, None, composite, [place]).unwrap()
    }

    /// A struct that holds a pointer, and is passed through if `live`.
    pub fn pointer_struct(&mut self, live: bool) {
        let Ids { float, input, .. } = self.ids;
        let pointer = self.b.type_pointer(None, StorageClass::Private, float);
        let kind = self.b.type_struct([pointer]);
        let composite = self.b.composite_construct(kind, None, [input]).unwrap();
        let pointer = self.b.composite_extract(pointer, None, composite, [0]).unwrap();
        if live {
            let value = self.b.load(float, None, pointer, None, []).unwrap();
            self.store_output(value);
        }
    }
}
