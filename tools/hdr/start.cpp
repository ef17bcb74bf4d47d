#include "tools/hdr/command.h"

int main(int argc, char** argv) {
  return hdr::tools::main(argc, argv);
}
