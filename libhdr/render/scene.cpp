#include "libhdr/render/scene.h"
