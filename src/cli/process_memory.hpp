// How this process deals with its memory.
#pragma once

namespace dovetail::cli {

/// Keeps some memory back until an allocation fails, and gives it up then: so that a large array may fail,
/// but not what is needed to tell all ranks of it, in words and through MPI.
void keep_memory_reserve();

/// What is freed is kept for what comes next. The phases need arrays of about one size after each other, and
/// otherwise every large one would be given back and come again as fresh pages, which cost more than what is
/// done with them (Decisions in README). Without effect where malloc is not that of the GNU library.
void keep_freed_memory();

} // namespace dovetail::cli
