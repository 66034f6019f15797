// OpenCL status codes as names, and the one check every call goes through.
#pragma once

#include <CL/cl.h>

#include <string>

namespace livecap::ocl {

// "CL_OUT_OF_RESOURCES", or "CL status -1234" when the code is not in the standard.
std::string status_name(cl_int status);

// Throws OclError "call failed: NAME (context)" unless status is CL_SUCCESS.
void check(cl_int status, const char* call, const std::string& context = {});

}  // namespace livecap::ocl
