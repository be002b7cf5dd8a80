//! A program by cranelift.
//!
//! What helps it: constants in a table instead of one instruction each, arguments and angles loaded where
//! they are used, one call for sine and cosine, fused operations, no unwinding information.

use crate::candidate::Candidate;
use costate::codegen::{Id, Node, Program};
use cranelift_codegen::Context;
use cranelift_codegen::ir::condcodes::FloatCC;
use cranelift_codegen::ir::types::F64;
use cranelift_codegen::ir::{
    AbiParam, Function, InstBuilder, MemFlagsData, SigRef, Signature, StackSlot, StackSlotData,
    StackSlotKind, Type, UserFuncName, Value,
};
use cranelift_codegen::isa::OwnedTargetIsa;
use cranelift_codegen::settings::{self, Configurable};
use cranelift_frontend::{FunctionBuilder, FunctionBuilderContext};
use memmap2::MmapMut;
use std::collections::HashMap;

extern "C" fn sin_cos(x: f64, out: *mut f64) {
    let (sin, cos) = x.sin_cos();
    // SAFETY: machine code passes the address of two doubles on its stack.
    unsafe {
        *out = sin;
        *out.add(1) = cos;
    }
}
extern "C" fn exp(x: f64) -> f64 {
    x.exp()
}
extern "C" fn exp_m1(x: f64) -> f64 {
    x.exp_m1()
}

fn target(opt_level: &str, algorithm: &str) -> OwnedTargetIsa {
    let mut flags = settings::builder();
    for (name, value) in [
        ("opt_level", opt_level),
        ("regalloc_algorithm", algorithm),
        ("enable_verifier", "false"),
        ("unwind_info", "false"),
        ("enable_probestack", "false"),
    ] {
        flags.set(name, value).unwrap();
    }
    cranelift_native::builder().unwrap().finish(settings::Flags::new(flags)).unwrap()
}

/// Compiles with an optimisation level ("none", "speed") and a register allocator ("backtracking",
/// "single_pass").
pub fn compile(program: &Program, opt_level: &str, algorithm: &str) -> Candidate {
    let isa = target(opt_level, algorithm);
    let mut context = Context::new();
    let mut signature = Signature::new(isa.default_call_conv());
    signature.params.extend([AbiParam::new(isa.pointer_type()); 3]);
    context.func = Function::with_name_signature(UserFuncName::user(0, 0), signature);
    let mut frontend = FunctionBuilderContext::new();
    let mut builder = FunctionBuilder::new(&mut context.func, &mut frontend);
    let table = Body::new(&mut builder, program, &isa).write();
    builder.finalize(isa.frontend_config());
    let code = context.compile(&*isa, &mut Default::default()).unwrap();
    assert!(code.buffer.relocs().is_empty());
    let bytes = code.code_buffer();
    let mut memory = MmapMut::map_anon(bytes.len()).unwrap();
    memory.copy_from_slice(bytes);
    let memory = memory.make_exec().unwrap();
    // SAFETY: the memory holds a function of this type.
    let function: extern "C" fn(*const f64, *mut f64, *const f64) =
        unsafe { std::mem::transmute(memory.as_ptr()) };
    let (inputs, outputs, bytes) = (program.inputs(), program.outputs(), memory.len());
    Candidate::new(bytes, move |x, y| {
        assert!(x.len() == inputs && y.len() == outputs && !memory.is_empty());
        function(x.as_ptr(), y.as_mut_ptr(), table.as_ptr());
    })
}

/// The one block of the function as it is written.
struct Body<'a, 'b> {
    builder: &'a mut FunctionBuilder<'b>,
    program: &'a Program,
    pointer: Type,
    arguments: [Value; 3],
    values: Vec<Option<Value>>,
    table: Vec<f64>,
    angles: HashMap<usize, i32>,
    slot: StackSlot,
    two: SigRef,
    one: SigRef,
}

impl<'a, 'b> Body<'a, 'b> {
    fn new(builder: &'a mut FunctionBuilder<'b>, program: &'a Program, isa: &OwnedTargetIsa) -> Self {
        let pointer = isa.pointer_type();
        let block = builder.create_block();
        builder.append_block_params_for_function_params(block);
        builder.switch_to_block(block);
        builder.seal_block(block);
        let arguments = [0, 1, 2].map(|k| builder.block_params(block)[k]);
        let mut two = Signature::new(isa.default_call_conv());
        two.params.extend([AbiParam::new(F64), AbiParam::new(pointer)]);
        let mut one = Signature::new(isa.default_call_conv());
        one.params.push(AbiParam::new(F64));
        one.returns.push(AbiParam::new(F64));
        let slots = program.nodes().iter().filter(|node| matches!(node, Node::Sin(_) | Node::Cos(_))).count();
        let data = StackSlotData::new(StackSlotKind::ExplicitSlot, 16 * slots.max(1) as u32, 3);
        Self {
            program,
            pointer,
            arguments,
            values: vec![None; program.nodes().len()],
            table: Vec::new(),
            angles: HashMap::new(),
            slot: builder.create_sized_stack_slot(data),
            two: builder.import_signature(two),
            one: builder.import_signature(one),
            builder,
        }
    }

    /// Loads made anew for every use can become part of the instruction that uses them.
    fn value(&mut self, id: Id) -> Value {
        let flags = MemFlagsData::new().with_notrap().with_aligned().with_readonly().with_can_move();
        match self.program.nodes()[id.index()] {
            Node::Constant(constant) => {
                self.table.push(constant);
                let offset = 8 * (self.table.len() as i32 - 1);
                self.builder.ins().load(F64, flags, self.arguments[2], offset)
            }
            Node::Input(k) => self.builder.ins().load(F64, flags, self.arguments[0], 8 * k as i32),
            Node::Sin(a) => {
                self.builder.ins().stack_load(self.pointer, F64, self.slot, self.angles[&a.index()])
            }
            Node::Cos(a) => {
                self.builder.ins().stack_load(self.pointer, F64, self.slot, self.angles[&a.index()] + 8)
            }
            _ => self.values[id.index()].unwrap(),
        }
    }

    fn call(&mut self, function: extern "C" fn(f64) -> f64, a: Id) -> Value {
        let argument = self.value(a);
        let address = self.builder.ins().iconst(self.pointer, function as usize as i64);
        let call = self.builder.ins().call_indirect(self.one, address, &[argument]);
        self.builder.inst_results(call)[0]
    }

    fn angle(&mut self, a: Id) {
        if !self.angles.contains_key(&a.index()) {
            let offset = 16 * self.angles.len() as i32;
            self.angles.insert(a.index(), offset);
            let argument = self.value(a);
            let out = self.builder.ins().stack_addr(self.pointer, self.slot, offset);
            let address = self.builder.ins().iconst(self.pointer, sin_cos as *const () as i64);
            self.builder.ins().call_indirect(self.two, address, &[argument, out]);
        }
    }

    fn step(&mut self, node: Node) -> Option<Value> {
        let operands: Vec<Id> = node.operands().collect();
        match node {
            Node::Constant(_) | Node::Input(_) => return None,
            Node::Sin(a) | Node::Cos(a) => {
                self.angle(a);
                return None;
            }
            Node::Exp(a) => return Some(self.call(exp, a)),
            Node::ExpM1(a) => return Some(self.call(exp_m1, a)),
            _ => {}
        }
        let v: Vec<Value> = operands.into_iter().map(|id| self.value(id)).collect();
        Some(match node {
            Node::Neg(_) => self.builder.ins().fneg(v[0]),
            Node::Add(..) => self.builder.ins().fadd(v[0], v[1]),
            Node::Sub(..) => self.builder.ins().fsub(v[0], v[1]),
            Node::Mul(..) => self.builder.ins().fmul(v[0], v[1]),
            Node::Div(..) => self.builder.ins().fdiv(v[0], v[1]),
            Node::MulAdd(..) => self.builder.ins().fma(v[0], v[1], v[2]),
            Node::MulSub(..) => {
                let minus = self.builder.ins().fneg(v[2]);
                self.builder.ins().fma(v[0], v[1], minus)
            }
            Node::NegMulAdd(..) => {
                let minus = self.builder.ins().fneg(v[0]);
                self.builder.ins().fma(minus, v[1], v[2])
            }
            Node::Sqrt(_) => self.builder.ins().sqrt(v[0]),
            Node::Less(..) => self.builder.ins().fcmp(FloatCC::LessThan, v[0], v[1]),
            _ => self.builder.ins().select(v[0], v[1], v[2]),
        })
    }

    /// Steps in the order of the program, results stored as soon as they are known; the table of constants.
    fn write(mut self) -> Vec<f64> {
        let flags = MemFlagsData::new().with_notrap().with_aligned();
        let results: Vec<Id> =
            self.program.results().iter().flat_map(|r| r.entries.iter().copied()).collect();
        let mut places: HashMap<usize, Vec<i32>> = HashMap::new();
        for (k, id) in (0..).zip(&results) {
            places.entry(id.index()).or_default().push(8 * k);
        }
        for (k, &node) in self.program.nodes().iter().enumerate() {
            self.values[k] = self.step(node);
            if self.values[k].is_some() {
                for &offset in places.remove(&k).iter().flatten() {
                    self.builder.ins().store(flags, self.values[k].unwrap(), self.arguments[1], offset);
                }
            }
        }
        for (k, &id) in (0..).zip(&results).filter(|(_, id)| places.contains_key(&id.index())) {
            let value = self.value(id);
            self.builder.ins().store(flags, value, self.arguments[1], 8 * k);
        }
        self.builder.ins().return_(&[]);
        self.table
    }
}
