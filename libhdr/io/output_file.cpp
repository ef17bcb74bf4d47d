#include "libhdr/io/output_file.h"
