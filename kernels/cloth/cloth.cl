// All kernels of this folder as one program.
#include "cloth/simulate.cl"
