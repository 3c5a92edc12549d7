// SPDX-License-Identifier: BSD-3-Clause
extern "C" int something_else() { return 1; }
