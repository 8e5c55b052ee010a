/// Vector instructions, for which the innermost loops are compiled several times. All give the same
/// bits: which are used decides how long something takes, never what comes out.
#pragma once

#include <string_view>

namespace skycap::geometry {

/// From the narrowest to the widest: what every processor of the kind has (SSE2 or NEON), and what
/// x86-64-v3 and x86-64-v4 add.
enum class InstructionSet { baseline, avx2, avx512 };

/// The widest that this processor has and limit_instruction_set() allows.
InstructionSet instruction_set();

/// Lets everything that is asked to do something from now on use `widest` at most, as an older
/// processor would. Before threads are started.
void limit_instruction_set(InstructionSet widest);

/// The same by its name. Throws Error{bad_usage} if it has none of them.
void limit_instruction_set(std::string_view widest);

}  // namespace skycap::geometry
