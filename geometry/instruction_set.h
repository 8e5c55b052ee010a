/// Selection of the vector instruction set. The innermost loops are compiled once per set. All sets
/// give bit-identical results, so the selection only affects speed.
#pragma once

#include <string_view>

namespace skycap::geometry {

/// Instruction sets in ascending width: the minimum of the architecture (SSE2 or NEON), x86-64-v3
/// and x86-64-v4.
enum class InstructionSet { baseline, avx2, avx512 };

/// Returns the widest set that both the processor and limit_instruction_set() allow.
InstructionSet instruction_set();

/// Restricts subsequent computations to `widest`, to emulate an older processor. Must be called
/// before threads are started.
void limit_instruction_set(InstructionSet widest);

/// Restricts subsequent computations to the set named `widest`. Throws Error{bad_usage} if the name
/// is unknown.
void limit_instruction_set(std::string_view widest);

}  // namespace skycap::geometry
