#pragma once
// The whole command as a function, for tests in the virtual machine, where starting a program with 260 shared libraries
// takes seconds and forking one takes none.

namespace hdr::tools {

/// What `hdr ARGUMENTS` does: prints, and returns the exit code.
int main(int argc, char** argv);

}  // namespace hdr::tools
