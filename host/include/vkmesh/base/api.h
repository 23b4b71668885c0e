// What shared libraries of vkmesh export.
#pragma once

/// Marks the functions and classes that programs may use. A shared library exports these and nothing else; a
/// static one nothing at all, so that a plugin built of it does not either.
#if defined(VKMESH_SHARED)
#define VKMESH_API __attribute__((visibility("default")))
#else
#define VKMESH_API
#endif

/// Takes a class back that is part of one that is exported.
#define VKMESH_LOCAL __attribute__((visibility("hidden")))
