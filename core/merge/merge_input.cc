#include "core/merge/merge_input.h"

#include <stdexcept>

namespace mapweld {

std::vector<MergeMember> number_members(const std::vector<std::uint32_t>& sizes) {
  std::vector<MergeMember> members;
  members.reserve(sizes.size());
  std::uint32_t next = 0;
  for (const std::uint32_t size : sizes) {
    MergeMember member;
    member.vertices.reserve(size);
    for (std::uint32_t i = 0; i < size; ++i) member.vertices.push_back(VertexId{next++});
    members.push_back(std::move(member));
  }
  return members;
}

MemberPair order_members(const std::vector<MergeMember>& members) {
  if (members.size() != 2) throw std::invalid_argument("a merge takes two maps");
  const bool first_is_smaller = members[0].vertices.size() < members[1].vertices.size();
  return first_is_smaller ? MemberPair{1, 0} : MemberPair{0, 1};
}

}  // namespace mapweld
