#include <slipmode/figures/file_figure.hpp>

namespace slipmode::figures {

std::vector<std::string> save_all(const results::StoreReader& store, const std::vector<FileFigure>& all,
                                  const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  std::vector<std::string> names;
  for (const FileFigure& figure : all) {
    save(figure.draw(store), {folder / (figure.name + ".svg"), folder / (figure.name + ".png")});
    names.push_back(figure.name);
  }
  return names;
}

}  // namespace slipmode::figures
