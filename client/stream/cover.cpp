#include "client/stream/cover.h"

namespace citystream::client {
namespace {

class Cover {
  public:
    Cover(const DirectoryCache& directory, const CoverQuestions& ask) : directory_(directory), ask_(ask) {}

    /// Covers the visible part of a tile; false when some of it could not be.
    bool visit(NodeIndex node) {
        if (!ask_.visible(node)) return true;
        if (!ask_.refined(node) || ask_.selected(node)) {
            if (ask_.drawable(node)) {
                out.push_back(node);
                return true;
            }
            return visit_descendants(node);
        }
        const size_t mark = out.size();
        bool covered = true;
        for (const NodeIndex child : directory_.node(node).children) {
            if (child != kNoNode) covered = visit(child) && covered;
        }
        if (covered || !ask_.drawable(node)) return covered;
        out.resize(mark);
        out.push_back(node);
        return true;
    }

    std::vector<NodeIndex> out;

  private:
    /// After zooming out the finer tiles are still here while the coarser one is on its way. All or nothing.
    bool visit_descendants(NodeIndex index) {
        const DirectoryNode& node = directory_.node(index);
        if (node.is_leaf() || node.unloaded_children != 0 || node.broken_children != 0) return false;
        const size_t mark = out.size();
        for (const NodeIndex child : node.children) {
            if (child == kNoNode || !ask_.visible(child)) continue;
            if (ask_.drawable(child)) {
                out.push_back(child);
            } else if (!visit_descendants(child)) {
                out.resize(mark);
                return false;
            }
        }
        return true;
    }

    const DirectoryCache& directory_;
    const CoverQuestions& ask_;
};

}  // namespace

std::vector<NodeIndex> cover_view(const DirectoryCache& directory, const CoverQuestions& ask) {
    if (directory.nodes().empty()) return {};
    Cover cover(directory, ask);
    cover.visit(0);
    return std::move(cover.out);
}

}  // namespace citystream::client
