#include "libhdr/probe/find_ball.h"
