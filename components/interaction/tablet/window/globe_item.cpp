#include "interaction/tablet/window/globe_item.hpp"

#include <QPainter>

namespace usher::tablet {

GlobeItem::GlobeItem(QQuickItem* parent) : QQuickPaintedItem(parent) {
  setAntialiasing(true);
  connect(this, &GlobeItem::colorChanged, this, [this] { update(); });
}

void GlobeItem::paint(QPainter* painter) {
  const double line = height() * 0.07, radius = (height() - line) / 2;
  painter->setRenderHint(QPainter::Antialiasing, true);
  painter->setPen(QPen(color_, line));
  painter->translate(width() / 2, height() / 2);
  painter->drawEllipse(QPointF(0, 0), radius, radius);
  painter->drawEllipse(QPointF(0, 0), radius * 0.45, radius);
  painter->drawLine(QPointF(0, -radius), QPointF(0, radius));
  for (const double latitude : {-0.5, 0.0, 0.5}) {
    const double half = radius * (latitude == 0.0 ? 1.0 : 0.866);
    painter->drawLine(QPointF(-half, latitude * radius), QPointF(half, latitude * radius));
  }
}

}  // namespace usher::tablet
