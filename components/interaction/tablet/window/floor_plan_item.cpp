#include "interaction/tablet/window/floor_plan_item.hpp"

#include <QPainter>

#include "interaction/tablet/window/place_names_item.hpp"

namespace usher::tablet {

FloorPlanItem::FloorPlanItem(QQuickItem* parent) : QQuickPaintedItem(parent) {
  setAntialiasing(true);
  connect(this, &FloorPlanItem::textSizeChanged, this, [this] { update(); });
}

void FloorPlanItem::set_screen(ScreenModel* screen) {
  if (screen == screen_) return;
  if (screen_ != nullptr) disconnect(screen_, nullptr, this, nullptr);
  screen_ = screen;
  if (screen_ != nullptr) {
    connect(screen_, &ScreenModel::mapChanged, this, [this] { update(); });
    connect(screen_, &ScreenModel::routeChanged, this, [this] { update(); });
  }
  emit screenChanged();
  update();
}

void FloorPlanItem::paint(QPainter* painter) {
  if (screen_ == nullptr || screen_->plan().empty()) return;
  const double scale = width() / screen_->plan().width;
  painter->setRenderHint(QPainter::SmoothPixmapTransform, true);
  painter->setRenderHint(QPainter::Antialiasing, true);
  painter->drawImage(QRectF(0, 0, width(), height()), screen_->building());
  paint_route(painter, route(scale));
  paint_places(painter, scale);
}

QPolygonF FloorPlanItem::route(double scale) const {
  QPolygonF points;
  if (screen_->view().page != Page::kJourney) return points;
  for (const auto& point : screen_->route()) {
    const auto at = screen_->plan().to_pixels(point, scale);
    points.append(QPointF(at.x(), at.y()));
  }
  return points;
}

void FloorPlanItem::paint_route(QPainter* painter, const QPolygonF& route) const {
  QPen pen(Theme::qt(kPalette.route), text_size_ * 0.18);
  pen.setCapStyle(Qt::RoundCap);
  pen.setJoinStyle(Qt::RoundJoin);
  painter->setPen(pen);
  painter->drawPolyline(route);
}

void FloorPlanItem::paint_places(QPainter* painter, double scale) const {
  painter->setPen(Qt::NoPen);
  for (const Place& place : screen_->places()) {
    const bool marked = screen_->marks(place);
    const auto at = screen_->plan().to_pixels(place.at, scale);
    const double radius = dot_radius(marked, text_size_);
    painter->setBrush(Theme::qt(marked ? kPalette.goal : kPalette.status));
    painter->drawEllipse(QPointF(at.x(), at.y()), radius, radius);
  }
}

}  // namespace usher::tablet
