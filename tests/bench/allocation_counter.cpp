// Operator new is replaced once per binary.
#include "tests/core/allocation_counter.cpp"
