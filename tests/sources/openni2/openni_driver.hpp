// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>

// The interface of drivers uses these of a library that is not installed.
#define XN_NEW(Type, ...) new Type(__VA_ARGS__)
#define XN_DELETE(pointer) delete pointer
#ifndef TRUE
#define TRUE 1
#define FALSE 0
#endif
#include <Driver/OniDriverAPI.h>
