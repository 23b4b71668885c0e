#include <vkmesh/base/result.h>

namespace vkmesh {

std::string Error::describe() const {
  std::string text;
  if (!where.file.empty()) text += where.file + ":";
  if (where.line) text += (where.file.empty() ? "line " : "") + std::to_string(*where.line) + ":";
  if (where.byte) text += (text.empty() ? "byte " : " byte ") + std::to_string(*where.byte) + ":";
  if (!text.empty()) text += " ";
  return text + message;
}

}  // namespace vkmesh
