#include "interaction/tablet/window/screen_model.hpp"

#include "interaction/tablet/core/tablet.hpp"

namespace usher::tablet {

QColor Theme::button(int kind) const {
  switch (static_cast<Kind>(kind)) {
    case Kind::kYes:
      return qt(kPalette.yes);
    case Kind::kNo:
      return qt(kPalette.no);
    case Kind::kService:
      return qt(kPalette.service);
    case Kind::kOption:
      break;
  }
  return qt(kPalette.option);
}

int ButtonsModel::rowCount(const QModelIndex& parent) const {
  return parent.isValid() ? 0 : count();
}

QVariant ButtonsModel::data(const QModelIndex& index, int role) const {
  if (!index.isValid() || index.row() < 0 || index.row() >= count()) return {};
  const Button& button = buttons_[static_cast<std::size_t>(index.row())];
  switch (role) {
    case kId:
      return QString::fromStdString(button.id);
    case kLabel:
      return QString::fromStdString(button.label);
    case kKind:
      return static_cast<int>(button.kind);
    case kPending:
      return button.id == pending_;
    case kActive:
      return button.active;
    default:
      return {};
  }
}

QHash<int, QByteArray> ButtonsModel::roleNames() const {
  return {{kId, "buttonId"},
          {kLabel, "label"},
          {kKind, "kind"},
          {kPending, "pending"},
          {kActive, "active"}};
}

void ButtonsModel::set(const std::vector<Button>& buttons, const std::string& pending) {
  if (buttons != buttons_) {
    beginResetModel();
    buttons_ = buttons;
    pending_ = pending;
    endResetModel();
    emit changed();
  } else if (pending != pending_) {
    pending_ = pending;
    if (!buttons_.empty()) emit dataChanged(index(0), index(count() - 1), {kPending});
  }
}

double ScreenModel::robotDegrees() const { return -view_.robot.yaw * 180.0 / 3.14159265358979; }

void ScreenModel::press(const QString& id) {
  if (on_press) on_press(id.toStdString());
}
void ScreenModel::pressStop() { press(Tablet::kStop); }
void ScreenModel::pressStart() { press(Tablet::kStart); }

void ScreenModel::key(const QString& letter) {
  if (letter == "\b") {
    typed_.chop(1);
  } else if (typed_.size() < static_cast<qsizetype>(Tablet::kMostTyped)) {
    typed_ += letter;
  }
  emit typedChanged();
  if (on_typed) on_typed(typed_.toStdString());
}

void ScreenModel::show(const View& view) {
  const bool another = view.screen_id != view_.screen_id || view.page != view_.page;
  const bool marked = view.place != view_.place || view.page != view_.page;
  view_ = view;
  primary_.set(view.primary, view.pending_id);
  secondary_.set(view.secondary, view.pending_id);
  service_.set(view.service, view.pending_id);
  if (another && !typed_.isEmpty()) {
    typed_.clear();
    emit typedChanged();
  }
  emit changed();
  if (marked) emit mapChanged();
}

void ScreenModel::show_building(const FloorPlan& plan) {
  plan_ = plan;
  building_ = plan.empty() ? QImage()
                           : QImage(reinterpret_cast<const uchar*>(plan_.pixels.data()), plan.width,
                                    plan.height, QImage::Format_RGB32);
  emit buildingChanged();
  emit changed();
  emit mapChanged();
}

void ScreenModel::show_places(const std::vector<Place>& places) {
  places_ = places;
  emit mapChanged();
}

void ScreenModel::show_route(const std::vector<geometry::Point2>& route) {
  route_ = route;
  emit routeChanged();
}

}  // namespace usher::tablet
