#include "interaction/tablet/window/floor_plan_item.hpp"

#include <QFontMetricsF>
#include <QPainter>
#include <QPainterPath>
#include <algorithm>

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
  }
  emit screenChanged();
  update();
}

void FloorPlanItem::paint(QPainter* painter) {
  labels_.clear();
  if (screen_ == nullptr || screen_->plan().empty()) return;
  const double scale = width() / screen_->plan().width;
  painter->setRenderHint(QPainter::SmoothPixmapTransform, true);
  painter->setRenderHint(QPainter::Antialiasing, true);
  painter->drawImage(QRectF(0, 0, width(), height()), screen_->building());
  if (screen_->view().page == Page::kJourney) paint_route(painter, scale);
  paint_places(painter, scale);
}

void FloorPlanItem::paint_route(QPainter* painter, double scale) const {
  QPainterPath path;
  bool first = true;
  for (const auto& point : screen_->route()) {
    const auto at = screen_->plan().to_pixels(point, scale);
    if (first) {
      path.moveTo(at.x(), at.y());
    } else {
      path.lineTo(at.x(), at.y());
    }
    first = false;
  }
  QPen pen(Theme::qt(kPalette.route), text_size_ * 0.25);
  pen.setCapStyle(Qt::RoundCap);
  pen.setJoinStyle(Qt::RoundJoin);
  painter->strokePath(path, pen);
}

void FloorPlanItem::paint_places(QPainter* painter, double scale) {
  QFont font = painter->font();
  font.setPixelSize(std::max(8, static_cast<int>(text_size_)));
  painter->setFont(font);
  const QFontMetricsF metrics(font);
  // The marked place is named first; of the others those whose names find room.
  std::vector<const Place*> order;
  for (const auto& place : screen_->places()) order.push_back(&place);
  std::stable_partition(order.begin(), order.end(),
                        [&](const Place* place) { return place->name == screen_->view().place; });
  for (const Place* place : order) {
    const bool marked = place->name == screen_->view().place;
    const auto at = screen_->plan().to_pixels(place->at, scale);
    const QPointF point(at.x(), at.y());
    const double radius = text_size_ * (marked ? 0.45 : 0.16);
    painter->setPen(Qt::NoPen);
    painter->setBrush(Theme::qt(marked ? kPalette.goal : kPalette.status));
    painter->drawEllipse(point, radius, radius);
    const QString name = QString::fromStdString(place->title.empty() ? place->name : place->title);
    QRectF box = metrics.boundingRect(name).adjusted(-4, -2, 4, 2);
    box.moveCenter(point + QPointF(0, radius + box.height() / 2));
    box.moveLeft(std::clamp(box.left(), 0.0, std::max(0.0, width() - box.width())));
    if (box.bottom() > height()) box.moveBottom(at.y() - radius);
    const bool free = std::none_of(labels_.begin(), labels_.end(),
                                   [&](const QRectF& other) { return other.intersects(box); });
    if (!free) continue;
    labels_.push_back(box);
    painter->setBrush(Theme::qt(kPalette.background));
    painter->setOpacity(0.8);
    painter->drawRoundedRect(box, 6, 6);
    painter->setOpacity(1.0);
    painter->setPen(Theme::qt(marked ? kPalette.goal : kPalette.text));
    painter->drawText(box, Qt::AlignCenter, name);
  }
}

}  // namespace usher::tablet
