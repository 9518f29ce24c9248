// A little memory for the time when there is none.
#pragma once

namespace dovetail::cli {

/// Keeps some memory back until an allocation fails, and gives it up then: so that a large array may fail,
/// but not what is needed to tell all ranks of it, in words and through MPI.
void keep_memory_reserve();

} // namespace dovetail::cli
