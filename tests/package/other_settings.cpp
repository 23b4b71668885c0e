// The embedding program after every installed header, with copies of inline functions: the library's own must
// stay exact.
#include <every_header.h>

#include "../../examples/embed.cpp"

static_assert(sizeof(glm::vec3) == 16, "this program's own vectors are aligned");

extern const void* const functions[];
const void* const functions[] = {
    reinterpret_cast<const void*>(&vkmesh::exact::reciprocal_root),
    reinterpret_cast<const void*>(&vkmesh::exact::arccosine),
    reinterpret_cast<const void*>(&vkmesh::exact::cube_root),
    reinterpret_cast<const void*>(&vkmesh::dihedral_angle),
};
